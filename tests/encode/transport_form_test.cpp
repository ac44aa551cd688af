// SPDX-License-Identifier: BSD-3-Clause
#include "encode/transport_form.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <random>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/parallel.h"
#include "encode/encode.h"
#include "encode/glb.h"
#include "encode/model_evaluation.h"
#include "encode/model_layout.h"
#include "encode/quantization.h"
#include "encode/transport_geometry.h"
#include "tests/encode/edge_jump.h"
#include "tests/encode/transport_scene.h"

namespace lfm::testing {
namespace {

// Half a step about each axis; three columns move.
constexpr double kFrameError = 1.01 * transport::kFrameStep * 1.2248;

std::string Bytes(const LightFieldModel& model, double psnr_db) {
  return EncodeTransport(model, {psnr_db}).bytes;
}
LightFieldModel Decoded(const std::string& bytes) { return DecodeTransport(bytes, "model").model; }

// In the order of the model.
LightFieldModel Decoded(const EncodedTransport& encoded) {
  return ReorderModel(Decoded(encoded.bytes), Inverse(encoded.order));
}
LightFieldModel ThereAndBack(const LightFieldModel& model, double psnr_db) {
  return Decoded(EncodeTransport(model, {psnr_db}));
}

TEST(TransportForm, MoreBytesAreMoreAccurate) {
  const LightFieldModel& model = GlossyModel();
  size_t bytes = 0;
  double psnr = 0;
  for (const double db : {36.0, 44.0, 52.0, 60.0}) {
    const EncodedTransport encoded = EncodeTransport(model, {db});
    const std::string& stream = encoded.bytes;
    EXPECT_GT(encoded.geometry_bytes, 0);
    EXPECT_LT(encoded.geometry_bytes + encoded.mean_bytes, static_cast<int64_t>(stream.size()));
    EXPECT_GT(stream.size(), bytes);
    const double shown = ShownPsnr(Decoded(encoded), model);
    // Hat-weighted matrices err less than what is shown, where three vertices' errors meet.
    EXPECT_GT(shown, std::min(db - 5, 46.0)) << db;
    EXPECT_GT(shown, psnr) << db;
    bytes = stream.size();
    psnr = shown;
  }
  EXPECT_LT(Bytes(model, 44).size() * 8, static_cast<size_t>(model.MapsBytes()));
}

TEST(TransportForm, ComesBackAsAConsistentModelOfTheSameObject) {
  const LightFieldModel& model = GlossyModel();
  const EncodedTransport encoded = EncodeTransport(model, {52});
  EXPECT_EQ(DecodeTransport(encoded.bytes, "model").parts_missing, 0);
  const LightFieldModel back = Decoded(encoded);
  EXPECT_NO_THROW(ValidateModel(back, "back"));
  EXPECT_EQ(back.mesh.triangles, model.mesh.triangles);
  EXPECT_EQ(back.grid, model.grid);
  EXPECT_EQ(back.direction_map, model.direction_map);
  for (size_t v = 0; v < model.mesh.vertices.size(); ++v) {
    EXPECT_LE((back.vertex_frames[v] - model.vertex_frames[v]).norm(), kFrameError);
    EXPECT_LE(back.vertex_terms[v], model.vertex_terms[v]);
  }
  for (size_t t = 0; t < model.placements.size(); ++t) {
    EXPECT_EQ(back.placements[t].edge_samples, model.placements[t].edge_samples);
  }
}

// Wherever the object stands.
TEST(TransportForm, VerticesMoveByNoMoreThanIsAllowed) {
  LightFieldModel model = GlossyModel();
  for (Eigen::Vector3d& p : model.mesh.vertices) p += Eigen::Vector3d(1e4, -300, 7);
  const double spacing = transport::MedianSampleSpacing(model);
  for (const double error : {0.01, 0.25, 1.0}) {
    const EncodedTransport encoded = EncodeTransport(model, {52, error});
    const LightFieldModel back = Decoded(encoded);
    double largest = 0;
    for (size_t v = 0; v < model.mesh.vertices.size(); ++v) {
      largest = std::max(largest, (back.mesh.vertices[v] - model.mesh.vertices[v]).norm());
    }
    EXPECT_LE(largest, error * spacing * (1 + 1e-9));
    EXPECT_GT(largest, 0.3 * error * spacing);
  }
  EXPECT_THROW(EncodeTransport(model, {52, 0}), Error);
  EXPECT_THROW(EncodeTransport(model, {52, NAN}), Error);
}

// Frames that follow no edge, and meshes that only the differences can hold.
TEST(TransportForm, AnyFramesAndAnyMeshComeBack) {
  LightFieldModel model = GlossyModel();
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (Eigen::Matrix3d& frame : model.vertex_frames) {
    frame = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                .normalized()
                .toRotationMatrix();
  }
  for (const bool turned : {false, true}) {
    if (turned) std::swap(model.mesh.triangles[5][0], model.mesh.triangles[5][1]);
    const LightFieldModel back = ThereAndBack(model, 52);
    EXPECT_EQ(back.mesh.triangles, model.mesh.triangles);
    for (size_t v = 0; v < model.vertex_frames.size(); ++v) {
      EXPECT_LE((back.vertex_frames[v] - model.vertex_frames[v]).norm(), kFrameError);
    }
  }
}

TEST(TransportForm, SamplesOnSharedEdgesAreEqualAgain) {
  const LightFieldModel back = Decoded(Bytes(GlossyModel(), 40));
  EXPECT_LE(LargestJumpAcrossEdges(back), 1.0);
}

TEST(TransportForm, GivesTheSameBytesForAnyNumberOfThreads) {
  SetThreadCount(1);
  const std::string one = Bytes(GlossyModel(), 48);
  const LightFieldModel model_one = Decoded(one);
  SetThreadCount(4);
  EXPECT_EQ(Bytes(GlossyModel(), 48), one);
  EXPECT_EQ(Decoded(one).view_pages[0][0].Bytes(), model_one.view_pages[0][0].Bytes());
  SetThreadCount(0);
}

// Any prefix that holds the mean view is a model, and the longer it is the better.
TEST(TransportForm, EveryPrefixIsAModelOrAnError) {
  const EncodedTransport encoded = EncodeTransport(GlossyModel(), {52});
  const std::string& bytes = encoded.bytes;
  const MeshOrder back = Inverse(encoded.order);
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
      const double psnr = ShownPsnr(ReorderModel(decoded.model, back), GlossyModel());
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

// Two chunks of vertices.
TEST(TransportForm, ManyVerticesInAnyNumberOfThreads) {
  const SyntheticLightField field = MakeLightField(
      MakeSphere(4), 6, 40, [](int) { return 3; }, GlossyAppearance);
  const LightFieldModel model =
      Encode(field.Source(), {.terms = 2, .transport_db = 0}, SilentProgress()).model;
  ASSERT_GT(model.mesh.vertices.size(), 1024U);
  SetThreadCount(1);
  const EncodedTransport encoded = EncodeTransport(model, {48});
  const std::string& one = encoded.bytes;
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
  EXPECT_GT(ShownPsnr(Decoded(encoded), model), 40);
}

// A vertex of no triangle has no place for terms.
TEST(TransportForm, AVertexOfNoTriangleComesBack) {
  const LightFieldModel model = WithIsolatedVertex(GlossyModel());
  const LightFieldModel back = ThereAndBack(model, 52);
  EXPECT_EQ(back.vertex_terms.back(), 0);
  EXPECT_EQ(back.mesh.triangles, model.mesh.triangles);
  EXPECT_GT(ShownPsnr(back, model), 40);
}

TEST(TransportForm, HoldsAtTheExtremes) {
  const auto round_trip = [](const LightFieldModel& model) { return ThereAndBack(model, 52); };
  const LightFieldModel mean = MakeSphereModel({.terms = 0}, GlossyAppearance);
  EXPECT_EQ(round_trip(mean).terms, 0);
  EXPECT_GT(ShownPsnr(round_trip(mean), mean), 48);
  for (const double level : {0.0, 1.0}) {
    const LightFieldModel flat =
        MakeSphereModel({.terms = 3}, [level](const Eigen::Vector3d&, const Eigen::Vector3d&) {
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

// Nonnegative factors stay so through the transforms.
TEST(TransportForm, NonnegativeMapsStayNonnegative) {
  const LightFieldModel model = MakeSphereModel(
      {.factorization = Factorization::kNmf, .terms = 3, .transport_db = 0}, GlossyAppearance);
  const LightFieldModel back = Decoded(Bytes(model, 36));
  ASSERT_TRUE(back.mean_in_terms);
  ASSERT_GE(back.terms, 2);
  const VertexRings rings = ComputeVertexRings(back.mesh);
  for (int v = 0; v < static_cast<int>(back.vertex_terms.size()); ++v) {
    const auto ring = rings.Ring(v);
    for (int k = 0; k < back.vertex_terms[v]; ++k) {
      const TermMaps maps = ReadVertexTerm(back, ring, v, k);
      for (const uint8_t code : maps.surface_codes) {
        ASSERT_GE(DecodeValue(maps.surface_range, code), 0) << v;
      }
      for (const uint8_t code : maps.view_codes) {
        ASSERT_GE(DecodeValue(maps.view_range, code), 0) << v;
      }
    }
  }
}

// A file that was written when this version of the form was new; it must be read as long as the
// version stays: 32 triangles, two terms, n = 3 and 5, GlossyAppearance at 48 dB.
TEST(TransportForm, TheFirstFileOfThisVersionIsStillRead) {
  const DecodedModel golden =
      ReadModel(std::string(LFM_SOURCE_DIR) + "/tests/encode/data/golden_v2.lfz");
  EXPECT_EQ(golden.parts_missing, 0);
  const LightFieldModel& model = golden.model;
  EXPECT_EQ(model.mesh.vertices.size(), 18U);
  EXPECT_EQ(model.mesh.triangles.size(), 32U);
  EXPECT_EQ(model.terms, 2);
  EXPECT_EQ(model.grid, 6);
  EXPECT_TRUE(ExamineTopology(model.mesh).closed);
  double squared = 0;
  for (int t = 0; t < 32; ++t) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const int v : model.mesh.triangles[t]) {
      EXPECT_NEAR(model.mesh.vertices[v].norm(), 50, 3);
      middle += model.mesh.vertices[v] / 3;
    }
    const Eigen::Vector3d to_eye = TriangleNormal(model.mesh, t);
    const Eigen::Vector3d shown =
        EvaluateModel(model, t, Eigen::Vector3d::Constant(1.0 / 3), to_eye).cast<double>();
    squared += (shown - GlossyAppearance(middle, to_eye)).squaredNorm();
  }
  EXPECT_LT(std::sqrt(squared / 96), 0.07);  // two terms, on a sphere of 32 triangles
}

TEST(TransportForm, ReadModelTellsTheFormsApart) {
  const std::string folder = ::testing::TempDir();
  const std::string glb = folder + "lfm_read_model.glb", lfz = folder + "lfm_read_model.lfz";
  WriteGlb(GlossyModel(), glb);
  const EncodedTransport encoded = EncodeTransport(GlossyModel(), {52});
  const std::string& bytes = encoded.bytes;
  WriteFileAtomically(lfz, bytes);
  EXPECT_EQ(ReadModel(glb).model.MapsBytes(), GlossyModel().MapsBytes());
  const DecodedModel whole = ReadModel(lfz);
  EXPECT_GT(ShownPsnr(ReorderModel(whole.model, Inverse(encoded.order)), GlossyModel()), 40);
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
