// SPDX-License-Identifier: BSD-3-Clause
#include "fields/cost_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lfm {
namespace {

constexpr double kExact_abs = 1e-9;

TEST(CostModel, CountsWhatIsMultiplied) {
  const PatchSize patches[] = {{100, 5}, {50, 3}};
  const RenderingCost cost = CostOf(patches, 20);
  EXPECT_EQ(cost.overhead, 160);   // (5 + 3) 20
  EXPECT_EQ(cost.per_pixel, 650);  // 5 100 + 3 50
  EXPECT_EQ(cost.Total(), 810);
  EXPECT_NEAR(cost.PerPixel(), 5.4, kExact_abs);
  EXPECT_EQ(CostOf({}, 20).PerPixel(), 0);
  // Equation 17: the light as it comes.
  EXPECT_EQ(CostOf({patches, 1}, 6144).Total(), 5 * (6144 + 100));
}

TEST(CostModel, DividesWhereTheMeasuredCostFalls) {
  const PatchSize halves[] = {{50, 3}, {50, 4}};
  // c = 5 (100 + N), c' = 3 (50 + N) + 4 (50 + N): d = 150 - 2 N.
  EXPECT_EQ(GainOfDivision({100, 5}, halves, 20), 110);
  EXPECT_EQ(GainOfDivision({100, 5}, halves, 75), 0);
  EXPECT_EQ(GainOfDivision({100, 5}, halves, 100), -50);
}

TEST(CostModel, TheRuleIsTheMeasureOfEqualParts) {
  // r parts of mu n terms: Equation 21 against Equation 20.
  const PatchSize quarters[] = {{25, 6}, {25, 6}, {25, 6}, {25, 6}};
  EXPECT_NEAR(GainOfDivision({100, 10}, quarters, 30),
              GainOfDivision({100, 10}, Shrinkage{4, 0.6}, 30), kExact_abs);
  // The limits of Section 4.3: linear (Equation 24) and flat (Equation 25).
  EXPECT_NEAR(GainOfDivision({100, 10}, Shrinkage{2, 0.5}, 30), 0.5 * 10 * 100, kExact_abs);
  EXPECT_NEAR(GainOfDivision({100, 10}, Shrinkage{2, 1.0}, 30), -10 * 30, kExact_abs);
}

TEST(CostModel, GivesThePapersWorkedExample) {
  EXPECT_NEAR(OptimalPatchPixels({2, 0.68}, 150), 168.75, kExact_abs);
  EXPECT_NEAR(GrowthOfCost(0.68, 2), 1.8496, kExact_abs);
  EXPECT_NEAR(GrowthOfCost(0.7, 1), 1.4, kExact_abs);
  // At p* a division neither pays nor costs.
  EXPECT_NEAR(GainOfDivision({16875, 100}, Shrinkage{2, 0.68}, 15000), 0, 1e-6);
}

TEST(CostModel, KnowsWhereNoOptimumIs) {
  EXPECT_EQ(OptimalPatchPixels({2, 0.5}, 150), 0);
  EXPECT_EQ(OptimalPatchPixels({4, 0.2}, 150), 0);
  EXPECT_EQ(OptimalPatchPixels({2, 1.0}, 150), std::numeric_limits<double>::infinity());
  EXPECT_EQ(OptimalPatchPixels({2, 0.68}, 0), 0);
}

TEST(CostModel, TakesMuFromTheSlope) {
  EXPECT_NEAR(MuOfSlope(1, 2), 0.5, kExact_abs);
  EXPECT_NEAR(MuOfSlope(0.5, 4), 0.5, kExact_abs);
  EXPECT_NEAR(MuOfSlope(0, 4), 1, kExact_abs);
  const PatchSize growing[] = {{4, 6}, {16, 12}, {64, 24}, {256, 48}};
  EXPECT_NEAR(SlopeOfTerms(growing), 0.5, kExact_abs);
  const PatchSize with_gaps[] = {{0, 3}, {4, 0}, {10, 10}, {100, 100}};
  EXPECT_NEAR(SlopeOfTerms(with_gaps), 1, kExact_abs);
  const PatchSize same[] = {{10, 3}, {10, 5}};
  EXPECT_EQ(SlopeOfTerms(same), 0);
  EXPECT_EQ(SlopeOfTerms({}), 0);
}

}  // namespace
}  // namespace lfm
