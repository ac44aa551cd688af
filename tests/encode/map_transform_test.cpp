// SPDX-License-Identifier: BSD-3-Clause
#include "encode/map_transform.h"

#include <gtest/gtest.h>

#include <cmath>
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

// The lowest `used` rows and columns of a matrix.
LowFrequencies Low(const Eigen::MatrixXf& coefficients, int used) {
  LowFrequencies low{used, {}};
  for (int row = 0; row < used; ++row) {
    for (int column = 0; column < used; ++column) low.values.push_back(coefficients(row, column));
  }
  return low;
}

Eigen::MatrixXf FromSquare(const MapTransform& transform, int side, const LowFrequencies& low) {
  TransformBuffers buffers;
  Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> samples(side, side);
  transform.FromSquare(side, low, std::span(samples.data(), static_cast<size_t>(samples.size())),
                       buffers);
  return samples;
}

TEST(MapTransform, SquaresComeBackAndKeepTheirNorm) {
  const MapTransform transform(kSides);
  for (const int side : kSides) {
    const Eigen::MatrixXf samples = Eigen::MatrixXf::Random(side, side);
    const Eigen::MatrixXf coefficients = transform.ToSquare(samples);
    EXPECT_NEAR(coefficients.norm(), samples.norm(), 1e-4 * samples.norm());
    EXPECT_LE((FromSquare(transform, side, Low(coefficients, side)) - samples).norm(), 1e-5 * side);
  }
}

TEST(MapTransform, TrianglesComeBackFromAsManyCoefficientsAsSamples) {
  const MapTransform transform(kSides);
  for (const int n : kSides) {
    const std::vector<float> samples = RandomPatch(n, 1);
    const Eigen::MatrixXf coefficients = transform.ToTriangle(n, samples);
    EXPECT_EQ(Eigen::MatrixXf(coefficients.triangularView<Eigen::StrictlyUpper>()).norm(), 0);
    std::vector<float> back(samples.size());
    TransformBuffers buffers;
    transform.FromTriangle(n, Low(coefficients, n), back, buffers);
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

// Against the sum of cosines, in double.
TEST(MapTransform, TheInverseIsTheSumOfCosines) {
  const MapTransform transform(kSides);
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  for (const int side : kSides) {
    for (const int used : {0, 1, 2, side / 2, side}) {
      LowFrequencies low{used, std::vector<float>(static_cast<size_t>(used) * used)};
      for (float& value : low.values) value = random() % 3 == 0 ? normal(random) : 0;
      const Eigen::MatrixXf samples = FromSquare(transform, side, low);
      for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
          double sum = 0;
          for (int row = 0; row < used; ++row) {
            for (int column = 0; column < used; ++column) {
              const auto cosine = [side](int k, int i) {
                return std::sqrt((k == 0 ? 1.0 : 2.0) / side) *
                       std::cos(M_PI * (2 * i + 1) * k / (2.0 * side));
              };
              sum += low.At(row, column) * cosine(row, y) * cosine(column, x);
            }
          }
          ASSERT_NEAR(samples(y, x), sum, 1e-5) << side << " " << used;
        }
      }
    }
  }
}

TEST(MapTransform, OpponentColorsAreOrthonormal) {
  EXPECT_LE((OpponentColors() * OpponentColors().transpose() - Eigen::Matrix3f::Identity()).norm(),
            1e-6);
}

}  // namespace
}  // namespace lfm::testing
