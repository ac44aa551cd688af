// SPDX-License-Identifier: BSD-3-Clause
#include "fields/slope_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/error.h"

namespace lfm {
namespace {

constexpr double kExactAbs = 1e-12;

std::vector<double> Octaves(int count) {
  std::vector<double> areas;
  for (int i = 0; i < count; ++i) areas.push_back(16 * std::exp2(i));
  return areas;
}

TEST(SlopeFit, PowerLawsAreFoundExactly) {
  const std::vector<double> areas = Octaves(8);
  for (const double power : {0.5, 1.0, 0.0, -0.25}) {
    std::vector<double> dimensions;
    for (const double area : areas) dimensions.push_back(3 * std::pow(area, power));
    const auto fit = FitSlope(areas, dimensions);
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->slope, power, kExactAbs);
    EXPECT_NEAR(*fit->half_width, 0, 1e-7);
    EXPECT_EQ(fit->points, 4);  // three octaves have four ends
    EXPECT_NEAR(fit->from_area, 256, 1e-9);
    EXPECT_NEAR(fit->to_area, 2048, 1e-9);
  }
}

TEST(SlopeFit, OnlyTheLastOctavesCountAndTheOrderDoesNot) {
  std::vector<double> areas, dimensions;
  for (int i = 7; i >= 0; --i) {
    areas.push_back(std::exp2(i));
    dimensions.push_back(i < 4 ? 8 : std::exp2(i - 1));
  }
  EXPECT_NEAR(FitSlope(areas, dimensions)->slope, 1, kExactAbs);
  EXPECT_LT(FitSlope(areas, dimensions, 7)->slope, 0.8);
}

// Five points, slope and interval worked by hand: x = 0..4 (times ln 2), y = 0, 1, 1, 3, 3 (times
// ln 2): slope 0.8, residual squares 0.8, standard error sqrt(0.8 / 3 / 10), t = 3.1824.
TEST(SlopeFit, IntervalIsStudents) {
  const auto fit = FitSlope({1, 2, 4, 8, 16}, {1, 2, 2, 8, 8}, 4);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->slope, 0.8, kExactAbs);
  EXPECT_NEAR(*fit->half_width, 3.1824 * std::sqrt(0.8 / 3 / 10), 1e-4);
}

TEST(SlopeFit, IntervalHoldsTheTruthInNineteenOfTwentyDraws) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 0.1);
  int held = 0;
  constexpr int kDraws = 4000;
  const std::vector<double> areas = Octaves(7);
  for (int draw = 0; draw < kDraws; ++draw) {
    std::vector<double> dimensions;
    for (const double area : areas) {
      dimensions.push_back(std::exp(0.7 * std::log(area) + noise(random)));
    }
    const auto fit = FitSlope(areas, dimensions, 6);
    held += std::abs(fit->slope - 0.7) <= *fit->half_width;
  }
  EXPECT_NEAR(held / static_cast<double>(kDraws), 0.95, 0.012);
}

TEST(SlopeFit, FactorsAreThoseOfTheTables) {
  EXPECT_NEAR(StudentFactor95(1), 12.7062, 1e-4);
  EXPECT_NEAR(StudentFactor95(10), 2.2281, 1e-4);
  EXPECT_NEAR(StudentFactor95(11), 2.2010, 2e-4);
  EXPECT_NEAR(StudentFactor95(30), 2.0423, 1e-4);
  EXPECT_NEAR(StudentFactor95(120), 1.9799, 1e-4);
  EXPECT_NEAR(StudentFactor95(1000000000), 1.95996, 1e-4);
  EXPECT_THROW(StudentFactor95(0), Error);
}

TEST(SlopeFit, WhatIsNoPointDoesNotCount) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(FitSlope({}, {}));
  EXPECT_FALSE(FitSlope({16}, {3}));
  EXPECT_FALSE(FitSlope({16, 16}, {3, 5}));        // one area
  EXPECT_FALSE(FitSlope({16, 1024}, {3, 5}));      // the first is six octaves away
  EXPECT_FALSE(FitSlope({1, 2, 4}, {0, 0, nan}));  // black
  const auto two = FitSlope({1, 2, nan, infinity, 4, -4}, {1, 2, 9, 9, 0, 9});
  ASSERT_TRUE(two);
  EXPECT_EQ(two->points, 2);
  EXPECT_NEAR(two->slope, 1, kExactAbs);
  EXPECT_FALSE(two->half_width);
  EXPECT_THROW(FitSlope({1, 2}, {1}), Error);
  EXPECT_THROW(FitSlope({1, 2}, {1, 2}, 0), Error);
}

TEST(SlopeFit, LocalSlopesSkipRepeatedAreas) {
  const auto slopes = LocalSlopes({1, 4, 4, 16}, {1, 2, 2, 8});
  ASSERT_EQ(slopes.size(), 2u);
  EXPECT_NEAR(slopes[0].area, 2, kExactAbs);
  EXPECT_NEAR(slopes[0].slope, 0.5, kExactAbs);
  EXPECT_NEAR(slopes[1].slope, 1, kExactAbs);
  EXPECT_TRUE(LocalSlopes({5}, {5}).empty());
}

TEST(SlopeFit, LinesAreFitted) {
  const auto fit = FitLine({0, 1, 2}, {1, 3, 5});
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->slope, 2, kExactAbs);
  EXPECT_NEAR(fit->offset, 1, kExactAbs);
  EXPECT_NEAR(fit->relative_residual, 0, kExactAbs);
  // 0, 1, 0 about its mean of 1/3: squares 2/3 of 1.
  EXPECT_NEAR(FitLine({0, 1, 2}, {0, 1, 0})->relative_residual, std::sqrt(2.0 / 3), kExactAbs);
  EXPECT_FALSE(FitLine({1, 1}, {1, 2}));
  EXPECT_EQ(FitLine({1, 2}, {0, 0})->relative_residual, 0);
}

}  // namespace
}  // namespace lfm
