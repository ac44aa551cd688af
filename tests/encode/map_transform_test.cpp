// SPDX-License-Identifier: BSD-3-Clause
#include "encode/map_transform.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "resample/light_field.h"

namespace lfm::testing {
namespace {

constexpr int kSides[] = {2, 3, 4, 7, 13, 25, 32};

std::vector<float> RandomPatch(int n, uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::vector<float> samples(PatchSampleCount(n));
  for (float& value : samples) value = normal(random);
  return samples;
}

TEST(MapTransform, SquaresComeBackAndKeepTheirNorm) {
  const MapTransform transform(kSides);
  for (const int side : kSides) {
    const Eigen::MatrixXf samples = Eigen::MatrixXf::Random(side, side);
    const Eigen::MatrixXf coefficients = transform.ToSquare(samples);
    EXPECT_NEAR(coefficients.norm(), samples.norm(), 1e-4 * samples.norm());
    EXPECT_LE((transform.FromSquare(side, coefficients) - samples).norm(), 1e-5 * side);
  }
}

TEST(MapTransform, TrianglesComeBackFromAsManyCoefficientsAsSamples) {
  const MapTransform transform(kSides);
  for (const int n : kSides) {
    const std::vector<float> samples = RandomPatch(n, 1);
    const Eigen::MatrixXf coefficients = transform.ToTriangle(n, samples);
    EXPECT_EQ(Eigen::MatrixXf(coefficients.triangularView<Eigen::StrictlyUpper>()).norm(), 0);
    std::vector<float> back(samples.size());
    transform.FromTriangle(n, coefficients, back);
    for (size_t i = 0; i < samples.size(); ++i) ASSERT_NEAR(back[i], samples[i], 1e-4) << n;
  }
}

// The squared sum, samples on the hypotenuse counting half.
TEST(MapTransform, TriangleCoefficientsHaveTheNormThatIsStated) {
  const MapTransform transform(kSides);
  for (const int n : kSides) {
    const std::vector<float> samples = RandomPatch(n, 2);
    double expected = 0;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i + j < n; ++i) {
        const double value = samples[PatchSampleIndex(n, i, j)];
        expected += value * value * (i + j == n - 1 ? 0.5 : 1.0);
      }
    }
    EXPECT_NEAR(transform.ToTriangle(n, samples).squaredNorm(), expected, 1e-4 * expected) << n;
  }
}

TEST(MapTransform, AConstantIsOneCoefficient) {
  const MapTransform transform(kSides);
  const std::vector<float> ones(PatchSampleCount(13), 1.F);
  Eigen::MatrixXf coefficients = transform.ToTriangle(13, ones);
  EXPECT_NEAR(coefficients(0, 0), 13 / std::sqrt(2.0), 1e-4);
  coefficients(0, 0) = 0;
  EXPECT_LE(coefficients.norm(), 1e-4);
}

TEST(MapTransform, OnlyTheLowFrequenciesNeedBeGiven) {
  const MapTransform transform(kSides);
  Eigen::MatrixXf full = Eigen::MatrixXf::Zero(32, 32);
  full.topLeftCorner(5, 5) = Eigen::MatrixXf::Random(5, 5);
  EXPECT_LE(
      (transform.FromSquare(32, full.topLeftCorner(5, 5)) - transform.FromSquare(32, full)).norm(),
      1e-5);
  EXPECT_EQ(transform.FromSquare(32, Eigen::MatrixXf(0, 0)).norm(), 0);
}

TEST(MapTransform, OpponentColorsAreOrthonormal) {
  EXPECT_LE((OpponentColors() * OpponentColors().transpose() - Eigen::Matrix3f::Identity()).norm(),
            1e-6);
}

}  // namespace
}  // namespace lfm::testing
