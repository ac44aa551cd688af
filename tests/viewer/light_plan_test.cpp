// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/light_plan.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"

namespace lfm {
namespace {

using Eigen::Vector3d;

void ExpectNear(const Vector3d& a, const Vector3d& b) { EXPECT_LT((a - b).norm(), 1e-12); }

TEST(LightPlan, ReadsAnglesAndVectors) {
  ExpectNear(ParseLightDirections("0,0").at(0), {1, 0, 0});
  ExpectNear(ParseLightDirections("90,0").at(0), {0, 1, 0});
  ExpectNear(ParseLightDirections("-30, 90").at(0), {0, 0, 1});
  ExpectNear(ParseLightDirections("3,0,4").at(0), {0.6, 0, 0.8});
  ExpectNear(ParseLightDirections("0,0,1e-300").at(0), {0, 0, 1});
  const auto several = ParseLightDirections("0,0; 0,2,0");
  ASSERT_EQ(several.size(), 2u);
  ExpectNear(several[1], {0, 1, 0});
  for (const char* bad : {"", "1", "1,2,3,4", "0,91", "a,b", "1,", "0,0,0", "nan,0", "inf,0",
                          "1,2;", "1 2", "1e999,0"}) {
    EXPECT_THROW(ParseLightDirections(bad), Error) << bad;
  }
}

TEST(LightPlan, OneLightAndTheSurroundingsMakeAFullTurn) {
  const auto plan = PlanLights(10, {{1, 0, 0}}, 4);
  ASSERT_EQ(plan.size(), 4u);
  EXPECT_EQ(plan[3].turn_deg, 280);
  ExpectNear(*plan[0].to_light, {1, 0, 0});
  ExpectNear(*plan[1].to_light, {0, 1, 0});
  ExpectNear(*plan[3].to_light, {0, -1, 0});
  EXPECT_FALSE(PlanLights(0, {}, 1).at(0).to_light.has_value());
}

TEST(LightPlan, SeveralDirectionsAreGoneThroughEvenly) {
  const auto plan = PlanLights(0, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 5);
  ExpectNear(*plan[0].to_light, {1, 0, 0});
  ExpectNear(*plan[1].to_light, {std::sqrt(0.5), std::sqrt(0.5), 0});
  ExpectNear(*plan[2].to_light, {0, 1, 0});
  ExpectNear(*plan[4].to_light, {0, 0, 1});
  // Places that stand still, and opposite ones.
  for (const FrameLight& frame : PlanLights(0, {{1, 0, 0}, {1, 0, 0}, {-1, 0, 0}}, 7)) {
    EXPECT_NEAR(frame.to_light->norm(), 1, 1e-12);
  }
  for (const FrameLight& frame : PlanLights(0, {{0, 0, 1}, {0, 0, 1}}, 3)) {
    ExpectNear(*frame.to_light, {0, 0, 1});
  }
}

}  // namespace
}  // namespace lfm
