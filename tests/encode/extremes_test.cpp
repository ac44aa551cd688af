// SPDX-License-Identifier: BSD-3-Clause
// Light fields at the edge of what can be captured: the encoder gives a sound model or says no.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "encode/encode.h"
#include "encode/model_error.h"
#include "encode/model_evaluation.h"
#include "encode/model_order.h"
#include "encode/pseudo_random.h"
#include "encode/transport_form.h"
#include "tests/encode/edge_jump.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

constexpr double kJump_levels = 1.01;    // half a code of rounding on either side
constexpr double kTransportLoss_db = 3;  // at 50 dB against models of 40 dB and more

Appearance Constant(double value) {
  return [value](const Eigen::Vector3d&, const Eigen::Vector3d&) -> Eigen::Vector3d {
    return Eigen::Vector3d::Constant(value);
  };
}

// Every colour is a colour, nothing jumps, the transport form holds the same, figures are true.
EncodeResult EncodeSoundly(const SyntheticLightField& field, const EncodeOptions& options) {
  EncodeResult result = Encode(field.Source(), options, SilentProgress());
  ValidateModel(result.model, "model");
  PseudoRandom random;
  const auto triangles = static_cast<int>(field.mesh.triangles.size());
  for (int i = 0; i < 200; ++i) {
    Eigen::Vector3d weights(random.Next() + 1, random.Next() + 1, random.Next() + 1);
    weights /= std::max(weights.sum(), 1e-9);
    const Eigen::Vector3d to_eye =
        Eigen::Vector3d(random.Next(), random.Next(), random.Next() + 1e-9).normalized();
    const Eigen::Vector3f color = EvaluateModel(result.model, i % triangles, weights, to_eye);
    EXPECT_TRUE(color.allFinite() && color.minCoeff() >= 0 && color.maxCoeff() <= 1);
  }
  EXPECT_LE(LargestJumpAcrossEdges(result.model), kJump_levels);
  EXPECT_NEAR(CompareWithLightField(field.Source(), result.model).psnr_db(), result.matrix_psnr_db,
              0.01);
  const LightFieldModel back = ReorderModel(
      DecodeTransport(result.transport.bytes, "model.lfz").model, Inverse(result.transport.order));
  EXPECT_GT(CompareWithLightField(field.Source(), back).psnr_db(),
            std::min(result.matrix_psnr_db, 50.0) - kTransportLoss_db);
  return result;
}

// A disc of `sectors` triangles round vertex 0, facing +z; all other vertices lie on the boundary.
TriangleMesh Fan(int sectors) {
  TriangleMesh mesh;
  mesh.vertices.emplace_back(0, 0, 0);
  for (int i = 0; i < sectors; ++i) {
    const double angle = 2 * std::numbers::pi * i / sectors;
    mesh.vertices.emplace_back(50 * std::cos(angle), 50 * std::sin(angle), 0);
    mesh.triangles.emplace_back(0, i + 1, (i + 1) % sectors + 1);
  }
  mesh.normals.assign(mesh.vertices.size(), {0, 0, 1});
  return mesh;
}

TriangleMesh OneTriangle() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {40, 0, 0}, {0, 40, 0}};
  mesh.triangles = {{0, 1, 2}};
  mesh.normals.assign(3, {0, 0, 1});
  return mesh;
}

int SevenAnEdge(int) { return 7; }

TEST(EncodeExtremes, AllWhiteStaysWhite) {
  const SyntheticLightField field = MakeLightField(MakeSphere(1), 6, 60, SevenAnEdge, Constant(1));
  const EncodeResult result = EncodeSoundly(field, {.terms = 3});
  EXPECT_EQ(result.terms_max, 0);
  EXPECT_EQ(result.matrix_psnr_db, 99);
  EXPECT_EQ(EvaluateModel(result.model, 0, {0.3, 0.3, 0.4}, {0, 0, 1}), Eigen::Vector3f::Ones());
}

TEST(EncodeExtremes, OnePhotographIsAPlainTexture) {
  const SyntheticLightField field =
      MakeLightField(MakeSphere(2), 8, 1, SevenAnEdge, GlossyAppearance);
  const EncodeResult result = EncodeSoundly(field, {.terms = 3});
  EXPECT_GT(result.unseen_triangles, static_cast<int>(field.mesh.triangles.size()) / 3);
  EXPECT_GT(result.matrix_psnr_mean_only_db, 50) << "one view tells nothing of directions";
}

TEST(EncodeExtremes, RankOneNeedsOneTermHoweverManyAreWanted) {
  const Appearance rank_one = [](const Eigen::Vector3d& p,
                                 const Eigen::Vector3d& d) -> Eigen::Vector3d {
    return Eigen::Vector3d::Constant(0.4 + 0.3 * std::sin(0.05 * p.x()) * d.x());
  };
  const SyntheticLightField field = MakeLightField(OneTriangle(), 8, 80, SevenAnEdge, rank_one);
  const EncodeResult one = EncodeSoundly(field, {.terms = 1});
  const EncodeResult eight = EncodeSoundly(field, {.terms = 8});
  EXPECT_GT(one.matrix_psnr_db, 50);
  EXPECT_GT(one.matrix_psnr_db, one.matrix_psnr_mean_only_db + 10);
  EXPECT_LE(eight.terms_max, 2) << "what is left is rounding";
  EXPECT_GE(eight.matrix_psnr_db, one.matrix_psnr_db - 1e-9);
}

TEST(EncodeExtremes, NoTermsAreTheMeanView) {
  const SyntheticLightField field =
      MakeLightField(OneTriangle(), 8, 80, SevenAnEdge, GlossyAppearance);
  EXPECT_EQ(EncodeSoundly(field, {.terms = 0}).matrix_psnr_by_terms_db.size(), 1U);
}

TEST(EncodeExtremes, AVertexOfFortyTrianglesAndABoundary) {
  const SyntheticLightField field = MakeLightField(
      Fan(40), 12, 80, SevenAnEdge, [](const Eigen::Vector3d& p, const Eigen::Vector3d& d) {
        return GlossyAppearance(p + Eigen::Vector3d(0, 0, 80), d);
      });
  const EncodeResult result = EncodeSoundly(field, {.terms = 4});
  EXPECT_GT(result.matrix_psnr_db, result.matrix_psnr_mean_only_db + 6);
}

TEST(EncodeExtremes, AnIsolatedVertexIsNoTrouble) {
  TriangleMesh mesh = MakeSphere(1);
  mesh.vertices.insert(mesh.vertices.begin() + 3, {500, 0, 0});
  mesh.normals.insert(mesh.normals.begin() + 3, {0, 0, 1});
  for (Eigen::Vector3i& triangle : mesh.triangles) {
    for (int& corner : triangle) corner += corner >= 3;
  }
  const EncodeResult result =
      EncodeSoundly(MakeLightField(mesh, 8, 60, SevenAnEdge, GlossyAppearance), {.terms = 2});
  EXPECT_EQ(result.model.vertex_terms[3], 0);
  EXPECT_EQ(result.terms_max, 2);
}

TEST(EncodeExtremes, PhotographsAtGrazingAnglesAlone) {
  const SyntheticLightField field =
      MakeLightField(MakeSphere(1), 12, 400, SevenAnEdge, GlossyAppearance,
                     [](double cosine) { return cosine > 0.02 && cosine < 0.17; });
  const EncodeResult result = EncodeSoundly(field, {.terms = 3});
  EXPECT_EQ(result.unseen_triangles, 0);
  EXPECT_GT(result.matrix_psnr_db, result.matrix_psnr_mean_only_db);
}

TEST(EncodeExtremes, ImputedHighlightsNearTwiceWhite) {
  const SyntheticLightField field = MakeLightField(
      MakeSphere(1), 8, 60, SevenAnEdge, [](const Eigen::Vector3d& p, const Eigen::Vector3d& d) {
        return Eigen::Vector3d::Constant(p.normalized().dot(d) > 0.8 ? 1.9 : 1e-6);
      });
  const EncodeResult result = EncodeSoundly(field, {.terms = 6});
  EXPECT_GT(result.matrix_psnr_db, result.matrix_psnr_mean_only_db + 3);
}

}  // namespace
}  // namespace lfm::testing
