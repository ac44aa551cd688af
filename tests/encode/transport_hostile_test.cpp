// SPDX-License-Identifier: BSD-3-Clause
// What whoever can compute a checksum may write into a file of the transport form.
#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/hash.h"
#include "encode/model_evaluation.h"
#include "encode/transport_form.h"
#include "encode/transport_stream.h"
#include "tests/encode/transport_scene.h"

namespace lfm::testing {
namespace {

std::string Bytes(const LightFieldModel& model, double psnr_db) {
  return EncodeTransport(model, {psnr_db}).bytes;
}

// A file in pieces.
struct File {
  std::vector<std::pair<transport::PartHeader, std::string>> parts;
};

File Split(const std::string& bytes) {
  File file;
  for (size_t at = sizeof(transport::FileHeader); at < bytes.size();) {
    auto& [header, content] = file.parts.emplace_back();
    std::memcpy(&header, bytes.data() + at, sizeof header);
    content = bytes.substr(at + sizeof header, header.bytes);
    at += sizeof header + header.bytes;
  }
  return file;
}

// With checksums and lengths that fit.
std::string Join(const File& file) {
  std::string bytes;
  transport::FileHeader head;
  head.parts = static_cast<uint32_t>(file.parts.size());
  transport::Append(bytes, head);
  for (auto [header, content] : file.parts) {
    header.bytes = content.size();
    header.checksum = Checksum(content.data(), content.size());
    transport::Append(bytes, header);
    bytes += content;
  }
  return bytes;
}

TEST(TransportHostile, NoticesEveryChangedByte) {
  const std::string bytes = Bytes(GlossyModel(), 40);
  std::mt19937 random(11);
  for (int trial = 0; trial < 150; ++trial) {
    std::string damaged = bytes;
    const size_t at = trial < 64 ? trial : random() % bytes.size();
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << random() % 8));
    try {
      const int missing = DecodeTransport(damaged, "damaged.lfz").parts_missing;
      // A part may seem to be longer than the file, or the parts fewer.
      EXPECT_TRUE(missing > 0 || at < sizeof(transport::FileHeader)) << at;
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).rfind("damaged.lfz: ", 0), 0U) << error.what();
    }
  }
}

// Damage under a checksum that fits: whoever writes hostile files can compute it.
TEST(TransportHostile, SurvivesDamagedParts) {
  const File file = Split(Bytes(GlossyModel(), 36));
  std::mt19937 random(13);
  int decoded = 0, refused = 0;
  for (int trial = 0; trial < 300; ++trial) {
    File hostile = file;
    for (auto& [header, content] : hostile.parts) {
      if (random() % 2 == 0) {
        const size_t place = random() % std::min<size_t>(content.size(), random() % 2 ? 60 : 1e9);
        content[place] = static_cast<char>(random());
      }
      if (random() % 40 == 0) header.term = static_cast<uint32_t>(random());
      if (random() % 40 == 0) header.first_vertex = static_cast<uint32_t>(random() % 4096);
      if (random() % 40 == 0) content.resize(content.size() / 2);
    }
    try {
      const LightFieldModel model = DecodeTransport(Join(hostile), "hostile.lfz").model;
      ++decoded;
      ValidateModel(model, "hostile");
      EXPECT_TRUE(EvaluateModel(model, 0, {0.3, 0.3, 0.4}, {0, 0, 1}).allFinite());
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).rfind("hostile.lfz: ", 0), 0U) << error.what();
      ++refused;
    }
  }
  EXPECT_GT(decoded, 10);
  EXPECT_GT(refused, 10);
}

// The geometry alone, cut off and damaged, in both of its forms.
TEST(TransportHostile, SurvivesDamagedGeometry) {
  std::mt19937 random(19);
  for (const LightFieldModel& model : {GlossyModel(), WithIsolatedVertex(GlossyModel())}) {
    const File file = Split(Bytes(model, 36));
    const std::string& geometry = file.parts[0].second;
    int refused = 0;
    for (int trial = 0; trial < 400; ++trial) {
      File hostile = file;
      hostile.parts.resize(2);
      std::string& content = hostile.parts[0].second;
      if (trial % 4 == 0) content.resize(random() % geometry.size());
      for (int flip = 0; flip < 2 && !content.empty(); ++flip) {
        const size_t at = random() % content.size();
        content[at] = static_cast<char>(content[at] ^ (1 << random() % 8));
      }
      try {
        ValidateModel(DecodeTransport(Join(hostile), "hostile.lfz").model, "hostile");
      } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).rfind("hostile.lfz: ", 0), 0U) << error.what();
        ++refused;
      }
    }
    EXPECT_GT(refused, 100);
  }
}

TEST(TransportHostile, HugeClaimsTakeNoMemory) {
  const File file = Split(Bytes(GlossyModel(), 36));
  for (const size_t field : {0, 1, 2, 3, 4, 5, 7, 8}) {
    for (const uint32_t claim : {uint32_t{0x7fffffff}, uint32_t{2000000}}) {
      File hostile = file;
      std::memcpy(hostile.parts[0].second.data() + 4 * field, &claim, 4);
      EXPECT_THROW(DecodeTransport(Join(hostile), "hostile.lfz"), Error) << field;
    }
  }
}

std::string Refusal(const File& file) {
  try {
    DecodeTransport(Join(file), "hostile.lfz");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// The numbers at the head of Draco's own stream are bounded too.
TEST(TransportHostile, TheMeshMayNotClaimMoreThanTheModel) {
  const File file = Split(Bytes(GlossyModel(), 36));
  constexpr size_t kVertices = sizeof(transport::GeometryHeader) + 12;
  for (size_t at = kVertices; at < kVertices + 4; ++at) {  // V, T in two bytes, 0
    File hostile = file;
    hostile.parts[0].second[at] = static_cast<char>(hostile.parts[0].second[at] ^ 0x40);
    EXPECT_NE(Refusal(hostile).find("its mesh is damaged"), std::string::npos) << at;
  }
}

// A vertex of no triangle has no place for terms: bits that say otherwise once wrote out of bounds.
TEST(TransportHostile, AVertexOfNoTriangleMayNotHaveTerms) {
  const LightFieldModel model = WithIsolatedVertex(GlossyModel());
  File file = Split(Bytes(model, 36));
  RangeEncoder coder;
  transport::TermModels models;
  bool before = true;
  const size_t vertices = model.mesh.vertices.size();
  for (size_t v = 0; v < vertices; ++v) {
    const bool has = v + 1 == vertices;
    coder.Encode(models.has[before], has);
    before = has;
  }
  models.sigma.Encode(coder, 0);
  CoefficientBlock view = MakeBlock(model.grid, 3, false);
  view.At(0, 0, 0) = 5;
  models.view.Encode(coder, view);
  file.parts.resize(3);
  file.parts[2].second.resize(sizeof(float));
  file.parts[2].second += coder.Finish();
  EXPECT_NE(Refusal(file).find("a vertex of no triangle has terms"), std::string::npos);
}

// Maps of a thousand vertices in a few bytes, all their coefficients zero.
TEST(TransportHostile, TermsMustHaveBytes) {
  const SyntheticLightField field = MakeLightField(
      MakeSphere(4), 12, 40, [](int) { return 3; }, GlossyAppearance);
  const LightFieldModel model =
      Encode(field.Source(), {.terms = 1, .transport_db = 0}, SilentProgress()).model;
  const EncodedTransport encoded = EncodeTransport(model, {36});
  File file = Split(encoded.bytes);
  RangeEncoder coder;
  transport::TermModels models;
  const VertexRings rings = ComputeVertexRings(model.mesh);
  for (uint32_t v = 0; v < transport::kChunk; ++v) {
    coder.Encode(models.has[1], true);
    models.sigma.Encode(coder, 0);
    const int old = encoded.order.vertices[v];
    for (int i = rings.offsets[old]; i < rings.offsets[old + 1]; ++i) {
      models.surface[transport::SizeClass(3)].Encode(coder, MakeBlock(3, 1, true));
    }
    models.view.Encode(coder, MakeBlock(12, 3, false));
  }
  const bool first = file.parts[2].first.first_vertex == 0;
  std::string& content = file.parts[first ? 2 : 3].second;
  content.resize(sizeof(float));
  content += coder.Finish();
  ASSERT_LT(content.size(), 400U);
  EXPECT_NE(Refusal(file).find("too short for its maps"), std::string::npos);
}

// So must the mean view: the writer fills up what codes too well.
TEST(TransportHostile, PatchesMustHaveBytes) {
  const SyntheticLightField field = MakeLightField(
      MakeSphere(2), 4, 40, [](int) { return 49; },
      [](const Eigen::Vector3d&, const Eigen::Vector3d&) {
        return Eigen::Vector3d(Eigen::Vector3d::Zero());
      });
  File file = Split(
      Bytes(Encode(field.Source(), {.terms = 0, .transport_db = 0}, SilentProgress()).model, 36));
  EXPECT_EQ(Refusal(file), "");
  std::string& mean = file.parts[1].second;
  EXPECT_EQ(mean.size(), 128 * 3 * 1225 / transport::kTexelsAByte);
  mean.resize(mean.size() - 2);
  EXPECT_NE(Refusal(file).find("its mean view is too short"), std::string::npos);
}

}  // namespace
}  // namespace lfm::testing
