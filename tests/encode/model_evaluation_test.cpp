// SPDX-License-Identifier: BSD-3-Clause
#include "encode/model_evaluation.h"

#include <gtest/gtest.h>

#include <random>

#include "encode/encode.h"
#include "encode/tiling.h"
#include "tests/encode/edge_jump.h"
#include "tests/encode/model_oracle.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

constexpr double kAgreement_abs = 2e-6;

class ModelEvaluation : public ::testing::Test {
 protected:
  // Neighbours of sizes that divide each other, that share a divisor, and that share none.
  static LightFieldModel MakeModel(const std::vector<int>& sizes,
                                   const Appearance& appearance = GlossyAppearance) {
    const SyntheticLightField field = MakeLightField(
        MakeSphere(1), 16, 80, [&](int t) { return sizes[t % sizes.size()]; }, appearance);
    return Encode(field.Source(), {.terms = 3}, SilentProgress()).model;
  }
  static Eigen::Vector3d RandomDirection(std::mt19937& random) {
    std::normal_distribution<double> normal;
    return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
  }
};

TEST_F(ModelEvaluation, AgreesWithTheDefinition) {
  const LightFieldModel model = MakeModel({5, 9, 4, 2});
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 3000; ++trial) {
    const int triangle = static_cast<int>(random() % model.placements.size());
    double a = uniform(random), b = uniform(random);
    if (a + b > 1) {
      a = 1 - a;
      b = 1 - b;
    }
    const Eigen::Vector3d weights(1 - a - b, a, b), to_eye = RandomDirection(random);
    for (const int terms : {0, 1, 3}) {
      const Eigen::Vector3f fast = EvaluateModel(model, triangle, weights, to_eye, {terms});
      const Eigen::Vector3d slow = SlowEvaluate(model, triangle, weights, to_eye, terms);
      ASSERT_LE((fast.cast<double>() - slow).cwiseAbs().maxCoeff(), kAgreement_abs);
    }
  }
}

TEST_F(ModelEvaluation, TakesTheSamplesAtTheSamples) {
  const LightFieldModel model = MakeModel({5, 9});
  for (int t = 0; t < static_cast<int>(model.placements.size()); ++t) {
    const PatchPlacement& place = model.placements[t];
    const int n = place.edge_samples;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i + j < n; ++i) {
        const Eigen::Vector3f color =
            EvaluateModel(model, t, PatchSampleWeights(n, i, j), {0, 0, 1}, {0});
        const Eigen::Vector2i texel = TexelOfSample(place, i, j);
        for (int c = 0; c < 3; ++c) {
          const int code = model.mean_pages[place.page].At<uint8_t>(texel.x(), texel.y(), c);
          ASSERT_NEAR(color[c], code / 255.0, 1e-6);
        }
      }
    }
  }
}

TEST_F(ModelEvaluation, EqualPatchesDoNotJumpAtAll) {
  const LightFieldModel model = MakeModel({9});
  EXPECT_LE(LargestJumpAcrossEdges(model, 0), 1e-3);
  EXPECT_LE(LargestJumpAcrossEdges(model, 3), 1e-3);
}

// Rounding alone: half a code on one side where sizes divide each other, on both sides otherwise.
TEST_F(ModelEvaluation, DifferentPatchesJumpByRoundingOnly) {
  const LightFieldModel nested = MakeModel({5, 9, 17});
  EXPECT_LE(LargestJumpAcrossEdges(nested, 0), 0.501);
  EXPECT_LE(LargestJumpAcrossEdges(nested, 3), 1.0);
  const LightFieldModel any = MakeModel({13, 9, 5, 7, 4, 2});
  EXPECT_LE(LargestJumpAcrossEdges(any, 0), 1.001);
  EXPECT_LE(LargestJumpAcrossEdges(any, 3), 2.0);
}

// Completions beyond black and white cannot be stored, and need not be.
TEST_F(ModelEvaluation, DoesNotJumpWhereBlackMeetsWhite) {
  const LightFieldModel model =
      MakeModel({9}, [](const Eigen::Vector3d& p, const Eigen::Vector3d&) -> Eigen::Vector3d {
        return Eigen::Vector3d::Constant(std::sin(p.x()) * std::sin(1.3 * p.z()) > 0 ? 1 : 0);
      });
  EXPECT_LE(LargestJumpAcrossEdges(model, 0), 1e-3);
}

// What a GPU does: the four texels, gutters included.
TEST_F(ModelEvaluation, PlainBilinearFilteringGivesTheSame) {
  const LightFieldModel model = MakeModel({9, 5});
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 2000; ++trial) {
    const int triangle = static_cast<int>(random() % model.placements.size());
    const PatchPlacement& place = model.placements[triangle];
    const double along = uniform(random), depth = uniform(random) / (place.edge_samples - 1);
    const Eigen::Vector3d weights(depth, (1 - depth) * along, (1 - depth) * (1 - along));
    const double x = weights[1] * (place.edge_samples - 1);
    const double y = weights[2] * (place.edge_samples - 1);
    const int i = static_cast<int>(x), j = static_cast<int>(y);
    const Eigen::Vector3f color = EvaluateModel(model, triangle, weights, {0, 0, 1}, {0});
    for (int c = 0; c < 3; ++c) {
      double sum = 0;
      for (int corner = 0; corner < 4; ++corner) {
        const int di = corner % 2, dj = corner / 2;
        const Eigen::Vector2i texel = TexelOfSample(place, i + di, j + dj);
        sum += (di ? x - i : 1 - x + i) * (dj ? y - j : 1 - y + j) *
               model.mean_pages[place.page].At<uint8_t>(texel.x(), texel.y(), c);
      }
      ASSERT_NEAR(255 * color[c], sum, 1e-3);
    }
  }
}

TEST_F(ModelEvaluation, ClampsColorsAndWeights) {
  LightFieldModel model = MakeModel({5});
  for (MapRange& range : model.view_ranges) range.bias = 100;
  const Eigen::Vector3f high = EvaluateModel(model, 0, {0.4, 0.3, 0.3}, {0, 0, 1});
  EXPECT_LE(high.maxCoeff(), 1);
  EXPECT_GE(high.minCoeff(), 0);
  const Eigen::Vector3f outside = EvaluateModel(model, 0, {-0.1, 1.2, -0.1}, {0, 0, 1}, {0});
  const Eigen::Vector3f corner = EvaluateModel(model, 0, {0, 1, 0}, {0, 0, 1}, {0});
  EXPECT_LE((outside - corner).norm(), 1e-6);
}

}  // namespace
}  // namespace lfm::testing
