// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/base_closing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

// Side walls of an upright cylinder from z = 0.6 up, part of the way round.
PointCloud Cylinder(const Eigen::Vector2d& center, double radius, double from_z = 0.6,
                    double full_turns = 1, double outwards = 1) {
  PointCloud cloud;
  for (double z = from_z; z < 20; z += 0.3) {
    for (double a = 0; a < 2 * M_PI * full_turns; a += 0.3 / radius) {
      const Eigen::Vector2d n(std::cos(a), std::sin(a));
      cloud.points.emplace_back(center.x() + radius * n.x(), center.y() + radius * n.y(), z);
      cloud.normals.emplace_back(outwards * n.x(), outwards * n.y(), 0);
      cloud.confidence.push_back(1);
    }
  }
  return cloud;
}

double FloorArea(const PointCloud& added, double spacing, const Eigen::Vector2d& center = {0, 0},
                 double within = 1e9) {
  double area = 0;
  for (size_t i = 0; i < added.points.size(); ++i) {
    if (added.normals[i].z() > -0.99) continue;
    if ((added.points[i].head<2>() - center).norm() < within) area += 2.25 * spacing * spacing;
  }
  return area;
}

TEST(BaseClosing, DiscUnderACylinder) {
  const PointCloud added = ContinueBelowPlatform(Cylinder({5, -3}, 15), 0.5);
  ASSERT_FALSE(added.points.empty());
  EXPECT_NEAR(FloorArea(added, 0.5), M_PI * 225, 0.05 * M_PI * 225);
  for (size_t i = 0; i < added.points.size(); ++i) {
    EXPECT_LE(added.points[i].z(), 0.9);
    EXPECT_GE(added.points[i].z(), -6 * 0.5 - 0.5);
    EXPECT_LE((added.points[i].head<2>() - Eigen::Vector2d(5, -3)).norm(), 15.6);
    EXPECT_NEAR(added.normals[i].norm(), 1, 1e-9);
    EXPECT_EQ(added.confidence[i], 0);
  }
}

TEST(BaseClosing, HoleStaysAHole) {
  PointCloud ring = Cylinder({0, 0}, 20);
  test::Append(ring, Cylinder({0, 0}, 10, 0.6, 1, -1));
  const PointCloud added = ContinueBelowPlatform(ring, 0.5);
  EXPECT_NEAR(FloorArea(added, 0.5), M_PI * 300, 0.06 * M_PI * 300);
  EXPECT_EQ(FloorArea(added, 0.5, {0, 0}, 9), 0);
}

TEST(BaseClosing, TwoFeet) {
  PointCloud feet = Cylinder({-15, 0}, 8);
  test::Append(feet, Cylinder({15, 0}, 8));
  const PointCloud added = ContinueBelowPlatform(feet, 0.5);
  EXPECT_NEAR(FloorArea(added, 0.5), 2 * M_PI * 64, 0.1 * 2 * M_PI * 64);
  EXPECT_EQ(FloorArea(added, 0.5, {0, 0}, 6), 0);
}

TEST(BaseClosing, GapInTheRingIsBridged) {
  const PointCloud added = ContinueBelowPlatform(Cylinder({0, 0}, 15, 0.6, 0.85), 0.5);
  EXPECT_NEAR(FloorArea(added, 0.5), M_PI * 225, 0.15 * M_PI * 225);
}

TEST(BaseClosing, RingHighUpIsContinuedDown) {
  const PointCloud added = ContinueBelowPlatform(Cylinder({0, 0}, 15, 8), 0.5);
  EXPECT_NEAR(FloorArea(added, 0.5), M_PI * 225, 0.06 * M_PI * 225);
}

TEST(BaseClosing, NothingUnderAClosedSurface) {
  test::CloudNoise all_round;
  all_round.hidden_below_normal_z = -2;
  all_round.along_normal_mm = 0;
  const auto cloud = test::MeasureCloud(test::MakeSphere(20, 5, {0, 0, 40}), 60000, all_round);
  EXPECT_LT(FloorArea(ContinueBelowPlatform(cloud, 0.5), 0.5), 20);
}

TEST(BaseClosing, Extremes) {
  EXPECT_TRUE(ContinueBelowPlatform({}, 0.5).points.empty());
  PointCloud one;
  one.points = {{1, 2, 3}};
  one.normals = {{1, 0, 0}};
  for (const auto& p : ContinueBelowPlatform(one, 0.5).points) EXPECT_TRUE(p.allFinite());
  PointCloud up;
  up.points.assign(50, {1, 2, 3});
  up.normals.assign(50, {0, 0, 1});
  EXPECT_TRUE(ContinueBelowPlatform(up, 0.5).points.empty());
}

}  // namespace
}  // namespace lfm
