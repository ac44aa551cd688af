// SPDX-License-Identifier: BSD-3-Clause
#include "resample/saturation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lfm {
namespace {

using Mask = Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic>;

/// Texture times shade plus gloss times a lobe over views: what a patch with a highlight shows.
Eigen::MatrixXf HighlightTruth(int rows, int views, unsigned seed, float peak) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0, 1);
  Eigen::MatrixXf truth(rows, views);
  for (int r = 0; r < rows; ++r) {
    const float albedo = 0.2F + 0.3F * uniform(random), gloss = 0.6F + 0.4F * uniform(random);
    for (int v = 0; v < views; ++v) {
      const float angle = 6.0F * (v - 0.4F * views) / views;
      truth(r, v) =
          albedo * (0.9F + 0.1F * std::sin(0.3F * v)) + peak * gloss * std::exp(-angle * angle);
    }
  }
  return truth;
}

CensoredMatrix Clip(const Eigen::MatrixXf& truth) {
  return {truth.cwiseMin(1.0F), (truth.array() >= 1.0F).matrix()};
}

double RmsOver(const Mask& mask, const Eigen::MatrixXf& difference) {
  const Eigen::ArrayXXd squared =
      mask.select(difference, Eigen::MatrixXf::Zero(mask.rows(), mask.cols())).cast<double>();
  return std::sqrt(squared.square().sum() / static_cast<double>(mask.count()));
}

TEST(ImputeCensored, RecoversAHighlightCutOff) {
  for (const float peak : {0.9F, 1.1F}) {
    const Eigen::MatrixXf truth = HighlightTruth(120, 40, 3, peak);
    const CensoredMatrix clipped = Clip(truth);
    ASSERT_GT(clipped.is_censored.count(), 50);
    const Eigen::MatrixXf result = ImputeCensored(clipped, 2);
    const double before = RmsOver(clipped.is_censored, clipped.values - truth);
    const double after = RmsOver(clipped.is_censored, result - truth);
    EXPECT_LT(after, 0.25 * before) << peak;
    // Not biased low: the mean of what was cut off comes back to a tenth.
    const double lost =
        clipped.is_censored.select(truth - clipped.values, Eigen::MatrixXf::Zero(120, 40)).sum();
    const double still =
        clipped.is_censored.select(truth - result, Eigen::MatrixXf::Zero(120, 40)).sum();
    EXPECT_LT(std::abs(still), 0.15 * lost) << peak;
  }
}

TEST(ImputeCensored, ToleratesNoise) {
  Eigen::MatrixXf truth = HighlightTruth(120, 40, 4, 1.0F);
  std::mt19937 random(5);
  std::normal_distribution<float> noise(0, 0.01F);
  Eigen::MatrixXf seen = truth;
  for (float& value : seen.reshaped()) value += noise(random);
  const CensoredMatrix clipped = Clip(seen);
  const Eigen::MatrixXf result = ImputeCensored(clipped, 2);
  EXPECT_LT(RmsOver(clipped.is_censored, result - truth),
            0.5 * RmsOver(clipped.is_censored, clipped.values - truth));
}

TEST(ImputeCensored, KeepsDataAndBounds) {
  const CensoredMatrix clipped = Clip(HighlightTruth(60, 30, 6, 1.5F));
  const Eigen::MatrixXf result = ImputeCensored(clipped, 1.3F);
  for (Eigen::Index r = 0; r < result.rows(); ++r) {
    for (Eigen::Index v = 0; v < result.cols(); ++v) {
      if (clipped.is_censored(r, v)) {
        EXPECT_GE(result(r, v), clipped.values(r, v));
        EXPECT_LE(result(r, v), 1.3F);
      } else {
        EXPECT_EQ(result(r, v), clipped.values(r, v));
      }
    }
  }
}

TEST(ImputeCensored, KeepsViewsThatAreSaturatedThroughout) {
  Eigen::MatrixXf truth = HighlightTruth(60, 30, 7, 0.5F);
  truth.col(4).setConstant(1.4F);
  const Eigen::MatrixXf result = ImputeCensored(Clip(truth), 2);
  EXPECT_GE(result.col(4).minCoeff(), 1.0F);
  EXPECT_TRUE(result.allFinite());
}

TEST(ImputeCensored, DefinesTheExtremes) {
  const Eigen::MatrixXf truth = HighlightTruth(30, 4, 8, 1.5F);  // too few views for a fit
  EXPECT_EQ(ImputeCensored(Clip(truth), 2), Clip(truth).values);
  const Eigen::MatrixXf none = HighlightTruth(30, 20, 9, 0.0F);  // nothing saturated
  EXPECT_EQ(ImputeCensored(Clip(none), 2), none);
  const Eigen::MatrixXf all = Eigen::MatrixXf::Constant(30, 20, 1.7F);
  EXPECT_EQ(ImputeCensored(Clip(all), 2), Eigen::MatrixXf::Ones(30, 20));
  const Eigen::MatrixXf nothing(0, 0);
  EXPECT_EQ(ImputeCensored({nothing, Mask(0, 0)}, 2).size(), 0);
  // All data zero, a few bounds: no number is lost.
  CensoredMatrix zero{Eigen::MatrixXf::Zero(30, 20), Mask::Constant(30, 20, false)};
  zero.is_censored(3, 4) = true;
  EXPECT_EQ(ImputeCensored(zero, 2), zero.values);
  // One row.
  const CensoredMatrix row = Clip(HighlightTruth(1, 20, 10, 1.5F));
  EXPECT_TRUE(ImputeCensored(row, 2).allFinite());
}

}  // namespace
}  // namespace lfm
