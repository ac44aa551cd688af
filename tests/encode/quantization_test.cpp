// SPDX-License-Identifier: BSD-3-Clause
#include "encode/quantization.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <vector>

namespace lfm {
namespace {

TEST(Quantization, AlphaSplitGivesBothMapsTheAppendixMaximum) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::VectorXd u =
        Eigen::VectorXd::NullaryExpr(50, [&] { return normal(random); }).normalized();
    const Eigen::VectorXd v =
        Eigen::VectorXd::NullaryExpr(80, [&] { return normal(random); }).normalized();
    const double lambda = std::pow(10.0, trial - 10);
    const double max_u = u.cwiseAbs().maxCoeff(), max_v = v.cwiseAbs().maxCoeff();
    // lambda lies in the right factor, as PCA returns it.
    const AlphaSplit split = SplitAlpha(max_u, lambda * max_v);
    const double expected = std::sqrt(lambda * max_u * max_v);
    EXPECT_NEAR((split.surface * u).cwiseAbs().maxCoeff(), expected, 1e-12 * expected);
    EXPECT_NEAR((split.view * lambda * v).cwiseAbs().maxCoeff(), expected, 1e-12 * expected);
    EXPECT_NEAR(split.surface * split.view, 1, 1e-12);
    // The appendix's own words: alpha = sqrt(max_u lambda / max_v), u <- lambda u / alpha.
    const double alpha = std::sqrt(max_u * lambda / max_v);
    EXPECT_NEAR(split.surface, lambda / alpha, 1e-12 * split.surface);
  }
}

TEST(Quantization, AlphaSplitOfNothingIsNeutral) {
  EXPECT_EQ(SplitAlpha(0, 3).surface, 1);
  EXPECT_EQ(SplitAlpha(3, 0).view, 1);
  EXPECT_EQ(SplitAlpha(std::numeric_limits<double>::quiet_NaN(), 1).surface, 1);
}

TEST(Quantization, SurfaceRangesHoldZeroExactlyAndLeaveRoomForCompletions) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (int trial = 0; trial < 1000; ++trial) {
    const float a = uniform(random), b = uniform(random) * std::pow(10.f, uniform(random) * 4);
    const MapRange range = SurfaceRange(std::min(a, b), std::max(a, b));
    EXPECT_EQ(DecodeValue(range, ZeroCode(range)), 0.f);
    for (const float value : {a, b}) {
      const uint8_t code = QuantizeValue(range, value);
      EXPECT_GE(code, 2);
      EXPECT_LE(code, 253);
      EXPECT_NEAR(DecodeValue(range, code), value, 0.5001f * range.scale / 255);
    }
  }
}

TEST(Quantization, SurfaceRangeOfNothingIsZero) {
  const MapRange range = SurfaceRange(0, 0);
  EXPECT_EQ(range.scale, 0);
  EXPECT_EQ(DecodeValue(range, QuantizeValue(range, 0)), 0);
}

TEST(Quantization, ViewRangesReachTheirEnds) {
  const MapRange range = ViewRange(-0.25f, 1.5f);
  EXPECT_EQ(QuantizeValue(range, -0.25f), 0);
  EXPECT_EQ(QuantizeValue(range, 1.5f), 255);
  EXPECT_FLOAT_EQ(DecodeValue(range, 255), 1.5f);
  for (float value = -0.25f; value <= 1.5f; value += 0.01f) {
    EXPECT_NEAR(DecodeValue(range, QuantizeValue(range, value)), value, 0.501f * 1.75f / 255);
  }
  EXPECT_EQ(QuantizeValue(range, -9), 0);
  EXPECT_EQ(QuantizeValue(range, 9), 255);
  EXPECT_EQ(QuantizeValue(range, std::numeric_limits<float>::quiet_NaN()), 0);
}

// Any count, and the same code wherever a value stands.
TEST(Quantization, ManyValuesGetTheCodesOfEach) {
  const MapRange range = ViewRange(-0.25f, 1.5f);
  for (const int count : {0, 1, 7, 8, 9, 31, 1000}) {
    std::vector<float> values;
    for (int i = 0; i < count; ++i) values.push_back(-0.3f + 0.0019f * static_cast<float>(i));
    if (count > 3) values[3] = std::numeric_limits<float>::quiet_NaN();
    if (count > 5) values[5] = std::numeric_limits<float>::infinity();
    std::vector<uint8_t> codes(values.size() + 1, 77);
    QuantizeValues(range, 2, values, codes.data());
    EXPECT_EQ(codes.back(), 77);
    for (int i = 0; i < count; ++i) {
      EXPECT_EQ(codes[i], QuantizeValue(range, 2 * values[i])) << values[i];
      uint8_t alone = 0;
      QuantizeValues(range, 2, std::span(values).subspan(i, 1), &alone);
      EXPECT_EQ(alone, codes[i]);
    }
    QuantizeValues({0, 3}, 1, values, codes.data());
    for (int i = 0; i < count; ++i) EXPECT_EQ(codes[i], 0);
  }
  const MapRange surface = SurfaceRange(-0.7f, 0.31f);
  uint8_t zero = 0;
  QuantizeValues(surface, 3, std::vector<float>{0}, &zero);
  EXPECT_EQ(zero, ZeroCode(surface));
}

TEST(Quantization, ViewRangeOfEqualValuesKeepsThem) {
  const MapRange range = ViewRange(0.3f, 0.3f);
  EXPECT_EQ(DecodeValue(range, QuantizeValue(range, 0.3f)), 0.3f);
}

}  // namespace
}  // namespace lfm
