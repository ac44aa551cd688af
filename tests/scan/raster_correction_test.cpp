// SPDX-License-Identifier: BSD-3-Clause
#include "scan/raster_correction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

namespace lfm {
namespace {

constexpr double kPi = std::numbers::pi;

/// What a phase shift of period 16 decodes where a camera pixel's footprint of slope.x by slope.y
/// projector pixels is centred at x: the mean of the squares' values, in closed form by fine sums.
double DecodeFringe(double x, const Eigen::Vector2d& slope) {
  constexpr double kPeriod = 16;
  constexpr int kFine = 400, kCross = 21;
  std::complex<double> sum = 0;
  for (int i = 0; i < kFine; ++i) {
    for (int j = 0; j < kCross; ++j) {
      const double at =
          x + slope.x() * ((i + 0.5) / kFine - 0.5) + slope.y() * ((j + 0.5) / kCross - 0.5);
      sum += std::polar(1.0, 2 * kPi * std::round(at) / kPeriod);
    }
  }
  const double phase = std::arg(sum * std::polar(1.0, -2 * kPi * x / kPeriod));
  return x + phase * kPeriod / (2 * kPi);
}

TEST(RasterCorrection, OffsetIsThatOfAFringeOfSquares) {
  for (const Eigen::Vector2d& slope :
       {Eigen::Vector2d(1.4, 0.1), {1.4, -0.5}, {0.8, 0.2}, {-1.1, 0.3}}) {
    for (double x = 100; x < 102; x += 0.13) {
      const double decoded = DecodeFringe(x, slope);
      EXPECT_NEAR(decoded - x, RasterOffsetPx(x, slope, 1), 0.02) << x << " " << slope.transpose();
      EXPECT_NEAR(RemoveRaster(decoded, slope, 1), x, 0.03) << x << " " << slope.transpose();
    }
  }
}

TEST(RasterCorrection, CoarseStepsAndUnknownSlopesAreLeftAlone) {
  EXPECT_EQ(RemoveRaster(10.3, {0.2, 0.1}, 1), 10.3);
  EXPECT_EQ(RemoveRaster(10.3, {0, 0}, 1), 10.3);
  EXPECT_EQ(RemoveRaster(10.3, {std::nan(""), 1}, 1), 10.3);
  EXPECT_EQ(RemoveRaster(10.3, {1.4, 0.1}, 0), 10.3);
}

TEST(RasterCorrection, CorrectsAWholeAxisAndStatesWhatIsLeft) {
  constexpr int kWidth = 60, kHeight = 5;
  const Eigen::Vector2d slope(1.37, 0.21);
  AxisCoordinates axis;
  const auto truth = [&](int x, int y) { return 200 + slope.x() * x + slope.y() * y; };
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      axis.position.push_back(static_cast<float>(DecodeFringe(truth(x, y), slope)));
      axis.sigma.push_back(0.01F);
      axis.confidence.push_back(x == 30 ? 0.0F : 1.0F);
    }
  }
  const AxisCoordinates corrected = CorrectRaster(axis, kWidth, kHeight, 1);
  double before = 0, after = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const size_t p = static_cast<size_t>(y) * kWidth + x;
      if (x == 30) {
        EXPECT_EQ(corrected.position[p], axis.position[p]);
        continue;
      }
      before += std::abs(axis.position[p] - truth(x, y));
      after += std::abs(corrected.position[p] - truth(x, y));
      EXPECT_GE(corrected.sigma[p], axis.sigma[p]);
      EXPECT_LT(corrected.sigma[p], 0.03F);
    }
  }
  EXPECT_LT(after, 0.25 * before);
  EXPECT_EQ(CorrectRaster(axis, kWidth, kHeight, 0).position, axis.position);
}

TEST(RasterCorrection, SlopesDoNotCrossJumps) {
  AxisCoordinates axis;
  axis.position = {10, 11, 12, 13, 60, 61, 62};
  axis.sigma.assign(7, 0.1F);
  axis.confidence.assign(7, 1);
  EXPECT_NEAR(SlopeAt(axis, 7, 1, 2, 0).x(), 1, 1e-6);
  EXPECT_NEAR(SlopeAt(axis, 7, 1, 3, 0).x(), 1, 1e-6);
  EXPECT_NEAR(SlopeAt(axis, 7, 1, 0, 0).x(), 1, 1e-6);
  axis.confidence[2] = 0;
  EXPECT_EQ(SlopeAt(axis, 7, 1, 3, 0).x(), 0);
  EXPECT_EQ(SlopeAt(axis, 7, 1, 1, 0).y(), 0);
}

}  // namespace
}  // namespace lfm
