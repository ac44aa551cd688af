// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/lanes/lane_math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sample_data/random.h"

namespace lfm {
namespace {

constexpr float kUlp = std::numeric_limits<float>::epsilon();

// Relative to the value, with an absolute floor.
void ExpectClose(double value, double expected, double error_rel, double at) {
  EXPECT_NEAR(value, expected, error_rel * std::abs(expected) + 1e-37) << "at " << at;
}

TEST(LaneMath, ExponentialIsGoodToAFewUnitsInTheLastPlace) {
  RandomStream random(1, 0, 0);
  for (int k = 0; k < 20000; ++k) {
    const auto x = static_cast<float>(random.Uniform(-87, 88));
    ExpectClose(Exp(x), std::exp(static_cast<double>(x)), 4 * kUlp, x);
  }
  EXPECT_EQ(Exp(0.0f), 1);
  EXPECT_EQ(Exp(-1e30f), 0);
  EXPECT_TRUE(std::isfinite(Exp(1e30f)));
}

TEST(LaneMath, LogarithmsAndPowersAreGoodToAFewUnitsInTheLastPlace) {
  RandomStream random(2, 0, 0);
  for (int k = 0; k < 20000; ++k) {
    const auto x = static_cast<float>(std::exp(random.Uniform(-80, 80)));
    EXPECT_NEAR(Log(x), std::log(static_cast<double>(x)),
                4 * kUlp * std::max(1.0, std::abs(std::log(static_cast<double>(x)))));
    const auto small = static_cast<float>(random.Uniform(-0.99, 0.99) * std::pow(10, -k % 8));
    ExpectClose(Log1p(small), std::log1p(static_cast<double>(small)), 6 * kUlp, small);
    ExpectClose(Expm1(-std::abs(small)), std::expm1(-static_cast<double>(std::abs(small))),
                6 * kUlp, small);
    const auto base = static_cast<float>(random.Uniform());
    const auto power = static_cast<float>(random.Uniform(0.1, 8));
    // The exponent's rounding grows with the logarithm.
    const double exponent = std::abs(power * std::log(base));
    ExpectClose(Pow(base, power), std::pow(static_cast<double>(base), power),
                8 * kUlp * (1 + exponent), base);
  }
  EXPECT_EQ(Pow(0.0f, 2.0f), 0);
}

TEST(LaneMath, SinesAndAnglesAreGoodToAFewUnitsOfOne) {
  RandomStream random(3, 0, 0);
  for (int k = 0; k < 20000; ++k) {
    const auto turns = static_cast<float>(random.Uniform(-2, 2));
    float sine, cosine;
    SinCosTurns(turns, sine, cosine);
    EXPECT_NEAR(sine, std::sin(2 * M_PI * turns), 2 * kUlp) << turns;
    EXPECT_NEAR(cosine, std::cos(2 * M_PI * turns), 2 * kUlp) << turns;
    const auto x = static_cast<float>(random.Uniform(-1, 1));
    const auto y = static_cast<float>(random.Uniform(-1, 1));
    EXPECT_NEAR(Atan2(y, x), std::atan2(static_cast<double>(y), x), 4 * kUlp) << y << " " << x;
  }
  EXPECT_EQ(Atan2(0.0f, 0.0f), 0);
  EXPECT_FLOAT_EQ(Atan2(0.0f, -1.0f), static_cast<float>(M_PI));
  EXPECT_FLOAT_EQ(Atan2(-1.0f, 0.0f), static_cast<float>(-M_PI / 2));
}

TEST(LaneMath, FloorIsExact) {
  for (const float x : {-2.0f, -1.5f, -1e-9f, -0.0f, 0.0f, 0.99999994f, 1.0f, 7.5f, 1e6f}) {
    EXPECT_EQ(Floor(x), std::floor(x)) << x;
  }
}

TEST(LaneMath, LanesHaveTheBitsOfSingleNumbers) {
  RandomStream random(4, 0, 0);
  for (int k = 0; k < 2000; ++k) {
    Floats x;
    for (int lane = 0; lane < kLaneCount; ++lane) {
      x[lane] = static_cast<float>(random.Uniform(0.001, 1));
    }
    const Floats e = Exp(x), l = Log(x), p = Pow(x, 0.37f), a = Atan2(x, 0.5f - x),
                 f = Floor(x * 9);
    Floats s, c;
    SinCosTurns(x, s, c);
    for (int lane = 0; lane < kLaneCount; ++lane) {
      const float one = x[lane];
      float sine, cosine;
      SinCosTurns(one, sine, cosine);
      ASSERT_EQ(e[lane], Exp(one));
      ASSERT_EQ(l[lane], Log(one));
      ASSERT_EQ(p[lane], Pow(one, 0.37f));
      ASSERT_EQ(a[lane], Atan2(one, 0.5f - one));
      ASSERT_EQ(f[lane], Floor(one * 9));
      ASSERT_EQ(s[lane], sine);
      ASSERT_EQ(c[lane], cosine);
    }
  }
}

TEST(LanePacker, WritesTheLanesOfAMaskInOrder) {
  Floats values;
  Ints numbers;
  ULongs wide;
  for (int lane = 0; lane < kLaneCount; ++lane) {
    values[lane] = static_cast<float>(lane);
    numbers[lane] = 10 * lane;
    wide[lane] = uint64_t{1} << (40 + lane);
  }
  for (unsigned bits = 0; bits < 1u << kLaneCount; ++bits) {
    Ints mask;
    for (int lane = 0; lane < kLaneCount; ++lane) mask[lane] = (bits >> lane & 1u) != 0 ? -1 : 0;
    float to[kLaneCount];
    int32_t to_int[kLaneCount];
    uint64_t to_wide[kLaneCount];
    const LanePacker packer(mask);
    packer.Write(to, values);
    packer.Write(to_int, numbers);
    packer.Write(to_wide, wide);
    int n = 0;
    for (int lane = 0; lane < kLaneCount; ++lane) {
      if ((bits >> lane & 1u) == 0) continue;
      ASSERT_EQ(to[n], static_cast<float>(lane));
      ASSERT_EQ(to_int[n], 10 * lane);
      ASSERT_EQ(to_wide[n], uint64_t{1} << (40 + lane));
      ++n;
    }
    EXPECT_EQ(packer.count(), n);
    EXPECT_EQ(MaskBits(mask), bits);
  }
}

}  // namespace
}  // namespace lfm
