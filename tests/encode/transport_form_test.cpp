// SPDX-License-Identifier: BSD-3-Clause
#include "encode/transport_form.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <random>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/hash.h"
#include "core/parallel.h"
#include "encode/encode.h"
#include "encode/glb.h"
#include "encode/model_evaluation.h"
#include "encode/transport_stream.h"
#include "tests/encode/edge_jump.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

// PSNR of the colours that two models show from in front and aside.
double ShownPsnr(const LightFieldModel& a, const LightFieldModel& b) {
  double sum = 0;
  int count = 0;
  for (int t = 0; t < static_cast<int>(a.placements.size()); ++t) {
    for (const Eigen::Vector3d& tilt :
         {Eigen::Vector3d(0.3, 0, 0), Eigen::Vector3d(0, -0.5, 0.2)}) {
      const Eigen::Vector3d to_eye = (TriangleNormal(a.mesh, t) + tilt).normalized();
      for (const Eigen::Vector3d& w :
           {Eigen::Vector3d(0.3, 0.3, 0.4), Eigen::Vector3d(0.8, 0.1, 0.1)}) {
        sum += (EvaluateModel(a, t, w, to_eye) - EvaluateModel(b, t, w, to_eye)).squaredNorm();
        count += 3;
      }
    }
  }
  return -10 * std::log10(sum / count + 1e-12);
}

std::string Bytes(const LightFieldModel& model, double psnr_db) {
  return EncodeTransport(model, {psnr_db}).bytes;
}
LightFieldModel Decoded(const std::string& bytes) { return DecodeTransport(bytes, "model").model; }

class TransportForm : public ::testing::Test {
 protected:
  static LightFieldModel Make(const EncodeOptions& options, const Appearance& appearance) {
    const SyntheticLightField field = MakeLightField(
        MakeSphere(2), 12, 120, [](int t) { return t % 2 == 0 ? 5 : 9; }, appearance);
    return Encode(field.Source(), options, SilentProgress()).model;
  }
  static const LightFieldModel& Glossy() {
    static const LightFieldModel model =
        Make({.target_db = 50, .max_terms = 6, .transport_db = 0}, GlossyAppearance);
    return model;
  }
};

TEST_F(TransportForm, MoreBytesAreMoreAccurate) {
  const LightFieldModel& model = Glossy();
  size_t bytes = 0;
  double psnr = 0;
  for (const double db : {36.0, 44.0, 52.0, 60.0}) {
    const EncodedTransport encoded = EncodeTransport(model, {db});
    const std::string& stream = encoded.bytes;
    EXPECT_GT(encoded.geometry_bytes, 0);
    EXPECT_LT(encoded.geometry_bytes + encoded.mean_bytes, static_cast<int64_t>(stream.size()));
    EXPECT_GT(stream.size(), bytes);
    const double shown = ShownPsnr(Decoded(stream), model);
    // Hat-weighted matrices err less than what is shown, where three vertices' errors meet.
    EXPECT_GT(shown, std::min(db - 5, 46.0)) << db;
    EXPECT_GT(shown, psnr) << db;
    bytes = stream.size();
    psnr = shown;
  }
  EXPECT_LT(Bytes(model, 44).size() * 8, static_cast<size_t>(model.MapsBytes()));
}

TEST_F(TransportForm, ComesBackAsAConsistentModelOfTheSameObject) {
  const LightFieldModel& model = Glossy();
  const DecodedModel decoded = DecodeTransport(Bytes(model, 52), "model");
  const LightFieldModel& back = decoded.model;
  EXPECT_EQ(decoded.parts_missing, 0);
  EXPECT_NO_THROW(ValidateModel(back, "back"));
  EXPECT_EQ(back.mesh.triangles, model.mesh.triangles);
  EXPECT_EQ(back.grid, model.grid);
  EXPECT_EQ(back.direction_map, model.direction_map);
  for (size_t v = 0; v < model.mesh.vertices.size(); ++v) {
    EXPECT_LE((back.mesh.vertices[v] - model.mesh.vertices[v]).norm(), 100.0 / (1 << 18));
    EXPECT_LE((back.vertex_frames[v] - model.vertex_frames[v]).norm(), 2e-3);
    EXPECT_LE(back.vertex_terms[v], model.vertex_terms[v]);
  }
  for (size_t t = 0; t < model.placements.size(); ++t) {
    EXPECT_EQ(back.placements[t].edge_samples, model.placements[t].edge_samples);
  }
}

TEST_F(TransportForm, SamplesOnSharedEdgesAreEqualAgain) {
  const LightFieldModel back = Decoded(Bytes(Glossy(), 40));
  EXPECT_LE(LargestJumpAcrossEdges(back), 1.0);
}

TEST_F(TransportForm, GivesTheSameBytesForAnyNumberOfThreads) {
  SetThreadCount(1);
  const std::string one = Bytes(Glossy(), 48);
  const LightFieldModel model_one = Decoded(one);
  SetThreadCount(4);
  EXPECT_EQ(Bytes(Glossy(), 48), one);
  EXPECT_EQ(Decoded(one).view_pages[0][0].Bytes(), model_one.view_pages[0][0].Bytes());
  SetThreadCount(0);
}

// Any prefix that holds the mean view is a model, and the longer it is the better.
TEST_F(TransportForm, EveryPrefixIsAModelOrAnError) {
  const std::string bytes = Bytes(Glossy(), 52);
  double before = 0;
  int models = 0, longest = -1;
  for (size_t length = 0; length <= bytes.size(); length += length < 400 ? 1 : 97) {
    try {
      // A block of its own, so that reading beyond it is seen.
      const std::string prefix = bytes.substr(0, length);
      const DecodedModel decoded = DecodeTransport(prefix, "cut.lfz");
      ++models;
      if (decoded.parts_missing == longest) continue;
      longest = decoded.parts_missing;
      const double psnr = ShownPsnr(decoded.model, Glossy());
      EXPECT_GE(psnr, before - 0.01) << length;
      before = psnr;
    } catch (const Error& error) {
      EXPECT_EQ(models, 0) << "an error after a prefix that was a model: " << error.what();
      EXPECT_EQ(std::string(error.what()).rfind("cut.lfz: ", 0), 0U) << error.what();
    }
  }
  EXPECT_GT(models, 0);
  EXPECT_GT(before, 20);
}

TEST_F(TransportForm, NoticesEveryChangedByte) {
  const std::string bytes = Bytes(Glossy(), 40);
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
TEST_F(TransportForm, SurvivesHostileParts) {
  const std::string bytes = Bytes(Glossy(), 36);
  std::mt19937 random(13);
  int decoded = 0, refused = 0;
  constexpr size_t kHeader = sizeof(transport::FileHeader), kPart = sizeof(transport::PartHeader);
  for (int trial = 0; trial < 300; ++trial) {
    std::string hostile = bytes.substr(0, kHeader);
    for (size_t at = kHeader; at < bytes.size();) {
      transport::PartHeader header;
      std::memcpy(&header, bytes.data() + at, kPart);
      std::string content = bytes.substr(at + kPart, header.bytes);
      at += kPart + header.bytes;
      if (random() % 2 == 0) {
        const size_t place = random() % std::min<size_t>(content.size(), random() % 2 ? 60 : 1e9);
        content[place] = static_cast<char>(random());
      }
      if (random() % 40 == 0) header.term = static_cast<uint32_t>(random());
      if (random() % 40 == 0) header.first_vertex = static_cast<uint32_t>(random() % 4096);
      if (random() % 40 == 0) content.resize(content.size() / 2);
      header.bytes = content.size();
      header.checksum = Checksum(content.data(), content.size());
      hostile.append(reinterpret_cast<const char*>(&header), kPart);
      hostile += content;
    }
    try {
      const LightFieldModel model = DecodeTransport(hostile, "hostile.lfz").model;
      ++decoded;
      ValidateModel(model, "hostile");
      EXPECT_TRUE(EvaluateModel(model, 0, {0.3, 0.3, 0.4}, {0, 0, 1}).allFinite());
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(decoded, 10);
  EXPECT_GT(refused, 10);
}

// Two chunks of vertices.
TEST_F(TransportForm, ManyVerticesInAnyNumberOfThreads) {
  const SyntheticLightField field = MakeLightField(
      MakeSphere(4), 6, 40, [](int) { return 3; }, GlossyAppearance);
  const LightFieldModel model =
      Encode(field.Source(), {.terms = 2, .transport_db = 0}, SilentProgress()).model;
  ASSERT_GT(model.mesh.vertices.size(), 1024U);
  SetThreadCount(1);
  const std::string one = Bytes(model, 48);
  const LightFieldModel back = Decoded(one);
  SetThreadCount(4);
  EXPECT_EQ(Bytes(model, 48), one);
  const LightFieldModel again = Decoded(one);
  SetThreadCount(0);
  for (int k = 0; k < back.terms; ++k) {
    EXPECT_EQ(again.surface_pages[k][0].Bytes(), back.surface_pages[k][0].Bytes());
    EXPECT_EQ(again.view_pages[k][0].Bytes(), back.view_pages[k][0].Bytes());
  }
  EXPECT_EQ(again.vertex_terms, back.vertex_terms);
  EXPECT_GT(ShownPsnr(back, model), 40);
}

// A vertex of no triangle has no place for terms.
TEST_F(TransportForm, AVertexOfNoTriangleComesBack) {
  LightFieldModel model = Glossy();
  model.mesh.vertices.push_back({1000, 0, 0});
  model.mesh.normals.push_back({0, 0, 1});
  model.vertex_frames.push_back(Eigen::Matrix3d::Identity());
  std::vector<MapRange> surface, view;
  const size_t vertices = model.vertex_terms.size();
  for (int k = 0; k < model.terms; ++k) {
    for (size_t v = 0; v < vertices; ++v) {
      surface.push_back(model.surface_ranges[k * vertices + v]);
      view.push_back(model.view_ranges[k * vertices + v]);
    }
    surface.push_back({0, 0});
    view.push_back({0, 0});
  }
  model.surface_ranges = surface;
  model.view_ranges = view;
  model.vertex_terms.push_back(0);
  model.view_slots = RankByTerms(model.vertex_terms);
  const LightFieldModel back = Decoded(Bytes(model, 52));
  EXPECT_EQ(back.vertex_terms.back(), 0);
  EXPECT_GT(ShownPsnr(back, model), 40);
}

TEST_F(TransportForm, HugeClaimsTakeNoMemory) {
  const std::string bytes = Bytes(Glossy(), 36);
  constexpr size_t kGeometry = sizeof(transport::FileHeader) + sizeof(transport::PartHeader);
  for (const size_t field : {0, 1, 2, 3, 4, 5}) {
    std::string hostile = bytes;
    const uint32_t huge = 0x7fffffff;
    std::memcpy(hostile.data() + kGeometry + 4 * field, &huge, 4);
    transport::PartHeader header;
    std::memcpy(&header, hostile.data() + sizeof(transport::FileHeader), sizeof header);
    header.checksum = Checksum(hostile.data() + kGeometry, header.bytes);
    std::memcpy(hostile.data() + sizeof(transport::FileHeader), &header, sizeof header);
    EXPECT_THROW(DecodeTransport(hostile, "hostile.lfz"), Error) << field;
  }
}

TEST_F(TransportForm, HoldsAtTheExtremes) {
  const auto round_trip = [](const LightFieldModel& model) { return Decoded(Bytes(model, 52)); };
  const LightFieldModel mean = Make({.terms = 0}, GlossyAppearance);
  EXPECT_EQ(round_trip(mean).terms, 0);
  EXPECT_GT(ShownPsnr(round_trip(mean), mean), 48);
  for (const double level : {0.0, 1.0}) {
    const LightFieldModel flat =
        Make({.terms = 3}, [level](const Eigen::Vector3d&, const Eigen::Vector3d&) {
          return Eigen::Vector3d(Eigen::Vector3d::Constant(level));
        });
    EXPECT_GT(ShownPsnr(round_trip(flat), flat), 48) << level;
  }
  EXPECT_THROW(EncodeTransport(mean, {10}), Error);
  EXPECT_THROW(EncodeTransport(mean, {NAN}), Error);
  LightFieldModel broken = mean;
  broken.placements.pop_back();
  EXPECT_THROW(EncodeTransport(broken, {52}), Error);
}

TEST_F(TransportForm, ReadModelTellsTheFormsApart) {
  const std::string folder = ::testing::TempDir();
  const std::string glb = folder + "lfm_read_model.glb", lfz = folder + "lfm_read_model.lfz";
  WriteGlb(Glossy(), glb);
  const std::string bytes = Bytes(Glossy(), 52);
  WriteFileAtomically(lfz, bytes);
  EXPECT_EQ(ReadModel(glb).model.MapsBytes(), Glossy().MapsBytes());
  const DecodedModel whole = ReadModel(lfz);
  EXPECT_GT(ShownPsnr(whole.model, Glossy()), 40);
  EXPECT_EQ(whole.parts_missing, 0);
  WriteFileAtomically(lfz, std::string_view(bytes).substr(0, bytes.size() - 1));
  EXPECT_EQ(ReadModel(lfz).parts_missing, 1);
  WriteFileAtomically(lfz, "LFMZ");
  EXPECT_THROW(ReadModel(lfz), Error);
  std::remove(glb.c_str());
  std::remove(lfz.c_str());
}

}  // namespace
}  // namespace lfm::testing
