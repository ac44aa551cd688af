// SPDX-License-Identifier: BSD-3-Clause
// Encode with a tolerance or a target in place of a fixed number of terms.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numeric>

#include "core/error.h"
#include "encode/encode.h"
#include "encode/glb.h"
#include "encode/model_evaluation.h"
#include "tests/encode/edge_jump.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

// One half is glossy, the other matte.
Eigen::Vector3d HalfGlossy(const Eigen::Vector3d& p, const Eigen::Vector3d& to_eye) {
  if (p.x() < 0) return Eigen::Vector3d(0.5, 0.4, 0.3) + 0.002 * p;
  return GlossyAppearance(p, to_eye);
}

class AdaptiveTerms : public ::testing::Test {
 protected:
  EncodeResult With(const EncodeOptions& options) const {
    return Encode(field_.Source(), options, SilentProgress());
  }
  SyntheticLightField field_ = MakeLightField(
      MakeSphere(2), 12, 120, [](int t) { return t % 2 == 0 ? 5 : 9; }, HalfGlossy);
};

TEST_F(AdaptiveTerms, MatteVerticesGetNoneGlossyOnesMore) {
  const EncodeResult result = With({.tolerance = 0.6});
  const LightFieldModel& model = result.model;
  int matte = 0, glossy = 0;
  for (size_t v = 0; v < model.vertex_terms.size(); ++v) {
    const double x = model.mesh.vertices[v].normalized().x();
    if (x < -0.4) {
      EXPECT_EQ(model.vertex_terms[v], 0) << v;
      ++matte;
    }
    if (x > 0.4 && model.vertex_terms[v] >= 2) ++glossy;
  }
  EXPECT_GT(matte, 10);
  EXPECT_GT(glossy, 10);
  EXPECT_EQ(std::accumulate(result.vertices_by_terms.begin(), result.vertices_by_terms.end(), 0),
            static_cast<int>(model.vertex_terms.size()));
  EXPECT_GE(result.vertices_by_terms[0], matte);
  // A finer tolerance costs more and errs less.
  const EncodeResult finer = With({.tolerance = 0.3});
  EXPECT_GT(finer.maps_bytes, result.maps_bytes);
  EXPECT_GT(finer.matrix_psnr_db, result.matrix_psnr_db);
}

TEST_F(AdaptiveTerms, AreTheDefault) {
  const EncodeResult result = With({});
  EXPECT_GT(result.vertices_by_terms[0], 10) << "the matte half";
  EXPECT_GE(result.terms_max, 2);
  const EncodeResult equal_mb = With({.target_mb = static_cast<double>(result.maps_bytes) * 1e-6});
  EXPECT_GT(result.matrix_psnr_db, equal_mb.matrix_psnr_db - 0.1) << "the best for these bytes";
  const EncodeResult more = With({.term_gain = 0.2});
  EXPECT_GT(more.maps_bytes, result.maps_bytes);
  EXPECT_GT(more.matrix_psnr_db, result.matrix_psnr_db);
  EXPECT_EQ(With({.term_gain = 255}).terms_max, 0);
}

TEST_F(AdaptiveTerms, TargetsAreMet) {
  const EncodeResult fixed = With({.terms = 3});
  const EncodeResult equal_db = With({.target_db = fixed.matrix_psnr_db});
  EXPECT_GE(equal_db.matrix_psnr_db, fixed.matrix_psnr_db);
  EXPECT_LT(static_cast<double>(equal_db.maps_bytes), 0.8 * static_cast<double>(fixed.maps_bytes));
  const double megabytes = static_cast<double>(fixed.maps_bytes) * 1e-6;
  const EncodeResult equal_mb = With({.target_mb = megabytes});
  EXPECT_LE(equal_mb.maps_bytes, fixed.maps_bytes);
  EXPECT_GT(equal_mb.matrix_psnr_db, fixed.matrix_psnr_db + 1);
  // Out of reach: all terms, no failure.
  EXPECT_EQ(With({.target_db = 99, .max_terms = 2}).model.terms, 2);
}

TEST_F(AdaptiveTerms, TheFirstTermsDoNotDependOnHowManyFollow) {
  const EncodeResult three = With({.terms = 3}), five = With({.terms = 5});
  EXPECT_LT(three.matrix_psnr_db, five.matrix_psnr_db);
  for (int t = 0; t < static_cast<int>(three.model.placements.size()); t += 7) {
    const Eigen::Vector3d to_eye =
        (TriangleNormal(three.model.mesh, t) + Eigen::Vector3d(0.2, 0.1, 0)).normalized();
    for (const int terms : {1, 2, 3}) {
      const Eigen::Vector3f a = EvaluateModel(three.model, t, {0.3, 0.3, 0.4}, to_eye, {terms});
      const Eigen::Vector3f b = EvaluateModel(five.model, t, {0.3, 0.3, 0.4}, to_eye, {terms});
      EXPECT_LE((a - b).cwiseAbs().maxCoeff(), 1.01 / 255) << t << ", " << terms;
    }
  }
}

// Pages that end early, tiles in the order of terms: written, read and shown as the oracle says.
TEST_F(AdaptiveTerms, ComesBackFromAFile) {
  const EncodeResult result = With({.target_db = 46, .max_texture_size = 256});
  ASSERT_GT(result.model.terms, 1);
  ASSERT_GT(result.vertices_by_terms[0], 0);
  const auto texels = [](const std::vector<Image>& pages) {
    int sum = 0;
    for (const Image& page : pages) sum += page.width() * page.height();
    return sum;
  };
  ASSERT_LT(texels(result.model.view_pages.back()), texels(result.model.view_pages.front()));
  ASSERT_LT(texels(result.model.surface_pages.back()), texels(result.model.mean_pages));
  const std::string file = ::testing::TempDir() + "lfm_adaptive_terms.glb";
  WriteGlb(result.model, file);
  const LightFieldModel back = ReadGlb(file);
  std::remove(file.c_str());
  EXPECT_EQ(back.vertex_terms, result.model.vertex_terms);
  EXPECT_EQ(back.MapsBytes(), result.model.MapsBytes());
  for (int t = 0; t < static_cast<int>(back.placements.size()); t += 5) {
    const Eigen::Vector3d to_eye = TriangleNormal(back.mesh, t);
    const Eigen::Vector3d w(0.5, 0.2, 0.3);
    const Eigen::Vector3f shown = EvaluateModel(back, t, w, to_eye);
    EXPECT_LE((shown - EvaluateModel(result.model, t, w, to_eye)).norm(), 1e-5);
  }
}

TEST_F(AdaptiveTerms, NoJumpAcrossEdgesWhereTermsDiffer) {
  const EncodeResult result = With({.tolerance = 1});
  EXPECT_LE(LargestJumpAcrossEdges(result.model), 1.0);
}

TEST_F(AdaptiveTerms, RefusesWhatCannotBe) {
  EXPECT_THROW(With({.tolerance = 1, .target_db = 40}), Error);
  EXPECT_THROW(With({.target_db = 40, .target_mb = 40}), Error);
  EXPECT_THROW(With({.terms = 3, .target_db = 40}), Error);
  EXPECT_THROW(With({.tolerance = -1}), Error);
  EXPECT_THROW(With({.terms = -2}), Error);
  EXPECT_THROW(With({.term_gain = -0.1}), Error);
  EXPECT_THROW(With({.target_db = 40, .max_terms = 17}), Error);
  try {
    With({.target_mb = 1e-4});
    FAIL() << "a model smaller than its mean view";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("the mean view alone takes"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace lfm::testing
