// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/alpha_wrap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mesh/self_intersection.h"
#include "mesh/surface_distance.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

const FreeSpace kNothingKnown({}, {}, 1);
constexpr double kBall_mm3 = 4.0 / 3 * std::numbers::pi * 27000;

// The points of a ball of radius 30 about (0, 0, 40) that do not face down too much.
PointCloud BallWithHole(double hidden_below_normal_z, int count) {
  test::CloudNoise noise;
  noise.hidden_below_normal_z = hidden_below_normal_z;
  return test::MeasureCloud(test::MakeSphere(30, 4, {0, 0, 40}), count, noise);
}

// The opening is 52 mm wide, the finest alpha 3.6 mm: entered, the ball would hold a few percent.
TEST(AlphaWrap, HoldsTheBallThoughASideIsMissing) {
  const PointCloud cloud = BallWithHole(-0.5, 8000);
  const WrapResult wrap = WrapPoints(cloud, 1.2, 0.3, kNothingKnown);
  EXPECT_TRUE(test::IsClosedManifold(wrap.mesh));
  EXPECT_TRUE(FindSelfIntersections(wrap.mesh).empty());
  EXPECT_DOUBLE_EQ(wrap.alpha_mm, 3.6);
  EXPECT_GT(wrap.wall_points, 0);
  // A flat lid takes away a cap 15 mm high: 16 % of the ball.
  EXPECT_GT(SignedVolume(wrap.mesh), 0.8 * kBall_mm3);
  EXPECT_LT(SignedVolume(wrap.mesh), 0.95 * kBall_mm3);
  for (const double d : DistancesToMesh(cloud.points, wrap.mesh)) EXPECT_LT(d, 0.6);
}

TEST(AlphaWrap, WallsOffNothingWhereDataAreWhole) {
  const WrapResult wrap = WrapPoints(BallWithHole(-2, 8000), 1.2, 0.3, kNothingKnown);
  EXPECT_EQ(wrap.wall_points, 0);
  EXPECT_DOUBLE_EQ(wrap.alpha_mm, 3.6);
  EXPECT_NEAR(SignedVolume(wrap.mesh), kBall_mm3, 0.04 * kBall_mm3);
}

// Openings that are lined with points are no holes in the data.
TEST(AlphaWrap, ARingKeepsItsHole) {
  constexpr double kRing = 30, kTube = 8;
  const PointCloud cloud = test::MeasureCloud(test::MakeTorus(kRing, kTube, 60, 96, 24), 9000,
                                              {.hidden_below_normal_z = -2});
  const WrapResult wrap = WrapPoints(cloud, 1.5, 0.3, kNothingKnown);
  EXPECT_EQ(wrap.wall_points, 0);
  const double volume = 2 * std::numbers::pi * std::numbers::pi * kRing * kTube * kTube;
  EXPECT_NEAR(SignedVolume(wrap.mesh), volume, 0.15 * volume);
  // As a torus: vertices - edges + faces = 0.
  EXPECT_EQ(2 * wrap.mesh.vertices.size(), wrap.mesh.triangles.size());
}

// A thin bowl could be a ball with a hole: only who looked into it knows.
TEST(AlphaWrap, ABowlIsOpenWhereItWasLookedInto) {
  PointCloud bowl;
  for (const double radius : {30.0, 28.0}) {
    const PointCloud side = test::MeasureCloud(test::MakeSphere(radius, 4, {0, 0, 40}), 8000,
                                               {.along_normal_mm = 0, .hidden_below_normal_z = -2});
    for (const Eigen::Vector3d& p : side.points) {
      if (p.z() < 45) bowl.points.push_back(p);
    }
  }
  const Eigen::Vector3d eye(0, 0, 500);
  PointCloud seen;  // the bottom of the bowl, from above
  for (const Eigen::Vector3d& p : bowl.points) {
    if ((p - Eigen::Vector3d(0, 0, 40)).norm() < 29) seen.points.push_back(p);
  }
  const FreeSpace free(seen, {{{eye}, 0, static_cast<int64_t>(seen.points.size())}}, 3);
  const WrapResult open = WrapPoints(bowl, 1.2, 0.3, free);
  const WrapResult closed = WrapPoints(bowl, 1.2, 0.3, kNothingKnown);
  EXPECT_TRUE(test::IsClosedManifold(open.mesh));
  EXPECT_GT(closed.wall_points, 0);
  EXPECT_GT(SignedVolume(closed.mesh), 0.45 * kBall_mm3);
  EXPECT_LT(SignedVolume(open.mesh), 0.3 * kBall_mm3);
}

TEST(AlphaWrap, TenPointsAreEnough) {
  PointCloud ten;
  for (int i = 0; i < 8; ++i)
    ten.points.emplace_back(10 * (i & 1), 10 * (i >> 1 & 1), 10 * (i >> 2));
  ten.points.emplace_back(5, 5, 13);
  ten.points.emplace_back(5, 5, 13);
  const WrapResult wrap = WrapPoints(ten, 10, 0.5, kNothingKnown);
  EXPECT_TRUE(test::IsClosedManifold(wrap.mesh));
  EXPECT_GT(SignedVolume(wrap.mesh), 0);
}

TEST(AlphaWrap, TooFewPointsAreAnError) {
  PointCloud three;
  three.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_NE(test::ErrorOf([&] { WrapPoints(three, 1, 0.1, kNothingKnown); }).find("4"),
            std::string::npos);
}

}  // namespace
}  // namespace lfm
