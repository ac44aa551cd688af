// SPDX-License-Identifier: BSD-3-Clause
#include "resample/imputation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace lfm {
namespace {

using Mask = Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic>;
using Kinds = Eigen::Matrix<Knowledge, Eigen::Dynamic, Eigen::Dynamic>;

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

PartialMatrix Clip(const Eigen::MatrixXf& truth) {
  PartialMatrix clipped{truth.cwiseMin(1.0F),
                        Kinds::Constant(truth.rows(), truth.cols(), Knowledge::kData)};
  clipped.knowledge =
      (truth.array() >= 1.0F)
          .select(Kinds::Constant(truth.rows(), truth.cols(), Knowledge::kLowerBound),
                  clipped.knowledge);
  return clipped;
}

Mask IsBound(const PartialMatrix& matrix) {
  return (matrix.knowledge.array() == Knowledge::kLowerBound).matrix();
}

double RmsOver(const Mask& mask, const Eigen::MatrixXf& difference) {
  const Eigen::ArrayXXd squared =
      mask.select(difference, Eigen::MatrixXf::Zero(mask.rows(), mask.cols())).cast<double>();
  return std::sqrt(squared.square().sum() / static_cast<double>(mask.count()));
}

TEST(Impute, RecoversAHighlightCutOff) {
  for (const float peak : {0.9F, 1.1F}) {
    const Eigen::MatrixXf truth = HighlightTruth(120, 40, 3, peak);
    const PartialMatrix clipped = Clip(truth);
    const Mask bounds = IsBound(clipped);
    ASSERT_GT(bounds.count(), 50);
    const Eigen::MatrixXf result = Impute(clipped, 2);
    EXPECT_LT(RmsOver(bounds, result - truth), 0.25 * RmsOver(bounds, clipped.values - truth))
        << peak;
    // Not biased low: the mean of what was cut off comes back.
    EXPECT_LT(std::abs((truth - result).sum()), 0.15 * (truth - clipped.values).sum()) << peak;
  }
}

TEST(Impute, ToleratesNoise) {
  const Eigen::MatrixXf truth = HighlightTruth(120, 40, 4, 1.0F);
  std::mt19937 random(5);
  std::normal_distribution<float> noise(0, 0.01F);
  Eigen::MatrixXf seen = truth;
  for (float& value : seen.reshaped()) value += noise(random);
  const PartialMatrix clipped = Clip(seen);
  const Mask bounds = IsBound(clipped);
  EXPECT_LT(RmsOver(bounds, Impute(clipped, 2) - truth),
            0.5 * RmsOver(bounds, clipped.values - truth));
}

TEST(Impute, FillsGapsFromTheOtherViews) {
  const Eigen::MatrixXf truth = HighlightTruth(93, 24, 11, 0.6F);
  PartialMatrix matrix{truth, Kinds::Constant(93, 24, Knowledge::kData)};
  // Views that miss a third of the patch each, another third each.
  for (int v = 0; v < 24; v += 3) {
    for (int r = 0; r < 31; ++r) {
      const int row = (r + 31 * (v / 3)) % 93;
      matrix.knowledge(row, v) = Knowledge::kMissing;
      matrix.values(row, v) = 77;  // must not matter
    }
  }
  const Mask gaps = (matrix.knowledge.array() == Knowledge::kMissing).matrix();
  const Eigen::MatrixXf result = Impute(matrix, 2);
  const Eigen::MatrixXf mean = truth.rowwise().mean().replicate(1, 24);
  EXPECT_LT(RmsOver(gaps, result - truth), 0.01);
  EXPECT_LT(RmsOver(gaps, result - truth), 0.1 * RmsOver(gaps, mean - truth));
  for (Eigen::Index r = 0; r < 93; ++r) {
    for (Eigen::Index v = 0; v < 24; ++v) {
      if (!gaps(r, v)) {
        EXPECT_EQ(result(r, v), truth(r, v));
      }
    }
  }
}

TEST(Impute, FitsAsManyTermsAsAreAskedFor) {
  // A second highlight elsewhere: three terms in all.
  Eigen::MatrixXf truth = HighlightTruth(93, 30, 13, 0.5F);
  for (int r = 0; r < 93; ++r) {
    for (int v = 0; v < 30; ++v) {
      truth(r, v) += 0.3F * static_cast<float>(r % 7) / 7 * std::exp(-0.1F * (v - 22) * (v - 22));
    }
  }
  PartialMatrix matrix{truth, Kinds::Constant(93, 30, Knowledge::kData)};
  for (int v = 0; v < 30; v += 2) {
    for (int r = 0; r < 40; ++r) matrix.knowledge((r + 7 * v) % 93, v) = Knowledge::kMissing;
  }
  const Mask gaps = (matrix.knowledge.array() == Knowledge::kMissing).matrix();
  std::vector<double> errors;
  for (const int terms : {1, 2, 3}) {
    errors.push_back(RmsOver(gaps, Impute(matrix, 2, terms) - truth));
  }
  EXPECT_LT(errors[1], 0.7 * errors[0]);
  EXPECT_LT(errors[2], 0.3 * errors[1]);
}

TEST(Impute, FillsGapsOfFewViewsBySeparableShade) {
  // Two views of one texture, the second at half the light and with a gap.
  Eigen::MatrixXf truth = HighlightTruth(30, 2, 12, 0);
  truth.col(1) = truth.col(0) / 2;
  PartialMatrix matrix{truth, Kinds::Constant(30, 2, Knowledge::kData)};
  for (int r = 12; r < 18; ++r) matrix.knowledge(r, 1) = Knowledge::kMissing;
  const Eigen::MatrixXf result = Impute(matrix, 2);
  EXPECT_LT((result - truth).cwiseAbs().maxCoeff(), 0.005);
}

TEST(Impute, LeavesARowOfWhichNothingIsKnownAtZeroAndGivesAViewTheMeans) {
  Eigen::MatrixXf values(6, 7);
  for (int v = 0; v < 7; ++v) values.col(v) << 0.1F, 0.2F, 0.3F, 0.5F, 0.6F, 0.7F;
  PartialMatrix matrix{values, Kinds::Constant(6, 7, Knowledge::kData)};
  matrix.knowledge.row(4).setConstant(Knowledge::kMissing);  // the second sample's green
  const Eigen::MatrixXf row = Impute(matrix, 2);
  for (int v = 0; v < 7; ++v) EXPECT_EQ(row(4, v), 0);
  for (int r : {0, 1, 2, 3, 5}) EXPECT_EQ(row.row(r), values.row(r));
  matrix.knowledge.setConstant(Knowledge::kData);
  matrix.knowledge.col(2).setConstant(Knowledge::kMissing);
  EXPECT_LT((Impute(matrix, 2) - values).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(Impute, KeepsDataAndBounds) {
  const PartialMatrix clipped = Clip(HighlightTruth(60, 30, 6, 1.5F));
  const Mask bounds = IsBound(clipped);
  const Eigen::MatrixXf result = Impute(clipped, 1.3F);
  for (Eigen::Index r = 0; r < result.rows(); ++r) {
    for (Eigen::Index v = 0; v < result.cols(); ++v) {
      if (bounds(r, v)) {
        EXPECT_GE(result(r, v), clipped.values(r, v));
        EXPECT_LE(result(r, v), 1.3F);
      } else {
        EXPECT_EQ(result(r, v), clipped.values(r, v));
      }
    }
  }
}

TEST(Impute, KeepsViewsThatAreSaturatedThroughout) {
  Eigen::MatrixXf truth = HighlightTruth(60, 30, 7, 0.5F);
  truth.col(4).setConstant(1.4F);
  const Eigen::MatrixXf result = Impute(Clip(truth), 2);
  EXPECT_GE(result.col(4).minCoeff(), 1.0F);
  EXPECT_TRUE(result.allFinite());
}

TEST(Impute, DefinesTheExtremes) {
  const Eigen::MatrixXf none = HighlightTruth(30, 20, 9, 0.0F);  // nothing to estimate
  EXPECT_EQ(Impute(Clip(none), 2), none);
  const Eigen::MatrixXf all = Eigen::MatrixXf::Constant(30, 20, 1.7F);
  EXPECT_LT((Impute(Clip(all), 2) - Eigen::MatrixXf::Ones(30, 20)).cwiseAbs().maxCoeff(), 0.01);
  EXPECT_EQ(Impute({Eigen::MatrixXf(0, 0), Kinds(0, 0)}, 2).size(), 0);
  const PartialMatrix lost{all, Kinds::Constant(30, 20, Knowledge::kMissing)};
  EXPECT_EQ(Impute(lost, 2), Eigen::MatrixXf::Zero(30, 20));
  // All data zero, one bound and one gap: no number is lost.
  PartialMatrix zero{Eigen::MatrixXf::Zero(30, 20), Kinds::Constant(30, 20, Knowledge::kData)};
  zero.knowledge(3, 4) = Knowledge::kLowerBound;
  zero.knowledge(5, 6) = Knowledge::kMissing;
  EXPECT_EQ(Impute(zero, 2), zero.values);
  for (const int views : {1, 2, 5, 6}) {
    for (const int rows : {3, 6}) {
      PartialMatrix small = Clip(HighlightTruth(rows, views, 10, 1.5F));
      small.knowledge(0, 0) = Knowledge::kMissing;
      const Eigen::MatrixXf result = Impute(small, 2);
      EXPECT_TRUE(result.allFinite());
      EXPECT_GE(result.minCoeff(), 0);
      EXPECT_LE(result.maxCoeff(), 2);
    }
  }
}

}  // namespace
}  // namespace lfm
