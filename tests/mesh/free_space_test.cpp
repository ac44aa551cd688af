// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/free_space.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/error.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

// A wall in the plane x = 0, seen from x = 200.
PointCloud Wall() {
  PointCloud wall;
  for (int i = 0; i < 100; ++i) {
    for (int j = 0; j < 100; ++j) wall.points.emplace_back(0, 0.5 * i - 25, 0.5 * j);
  }
  return wall;
}
const Eigen::Vector3d kEye(200, 0, 25);

ScanSight Whole(const PointCloud& cloud, std::vector<Eigen::Vector3d> eyes = {kEye}) {
  return {std::move(eyes), 0, static_cast<int64_t>(cloud.points.size())};
}

TEST(FreeSpace, IsWhatLiesBeforeTheWall) {
  const PointCloud wall = Wall();
  const FreeSpace free(wall, {Whole(wall)}, 1);
  EXPECT_FALSE(free.Empty());
  EXPECT_TRUE(free.IsFree({50, 0, 25}));
  EXPECT_TRUE(free.IsFree({2, 10, 40}));
  EXPECT_FALSE(free.IsFree({0.5, 0, 25}));   // within the margin
  EXPECT_FALSE(free.IsFree({-2, 0, 25}));    // behind
  EXPECT_FALSE(free.IsFree({2, 40, 25}));    // beside
  EXPECT_FALSE(free.IsFree({2, 24.9, 25}));  // at the silhouette
  EXPECT_FALSE(free.IsFree({300, 0, 25}));   // behind the eye
  EXPECT_FALSE(free.IsFree(kEye * std::numeric_limits<double>::quiet_NaN()));
}

TEST(FreeSpace, AHoleInTheWallClaimsNothing) {
  PointCloud holed;
  for (const Eigen::Vector3d& p : Wall().points) {
    if ((p - Eigen::Vector3d(0, 0, 25)).norm() > 8) holed.points.push_back(p);
  }
  const FreeSpace free(holed, {Whole(holed)}, 1);
  EXPECT_FALSE(free.IsFree({5, 0, 25}));
  EXPECT_TRUE(free.IsFree({5, 15, 25}));
}

TEST(FreeSpace, OneStrayPointHidesNothingButItsPlace) {
  PointCloud wall = Wall();
  wall.points.emplace_back(-400, 0, 25);  // far behind, between the others
  const FreeSpace free(wall, {Whole(wall)}, 1);
  EXPECT_FALSE(free.IsFree({-5, 0, 25}));
  EXPECT_TRUE(free.IsFree({5, 0, 25}));
}

TEST(FreeSpace, FarFromTheOrigin) {
  const Eigen::Vector3d far(10000, -10000, 10000);
  PointCloud wall = Wall();
  for (Eigen::Vector3d& p : wall.points) p += far;
  const FreeSpace free(wall, {Whole(wall, {kEye + far})}, 1);
  EXPECT_TRUE(free.IsFree(far + Eigen::Vector3d(2, 10, 40)));
  EXPECT_FALSE(free.IsFree(far + Eigen::Vector3d(-2, 0, 25)));
}

TEST(FreeSpace, ExtremesKnowNothing) {
  EXPECT_TRUE(FreeSpace({}, {}, 1).Empty());
  const PointCloud wall = Wall();
  EXPECT_TRUE(FreeSpace(wall, {Whole(wall, {})}, 1).Empty());
  EXPECT_TRUE(FreeSpace(wall, {{{kEye}, 5, 5}}, 1).Empty());
  EXPECT_TRUE(FreeSpace(wall, {{{kEye}, 0, 50}}, 1).Empty());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(FreeSpace(wall, {Whole(wall, {{nan, 0, 0}})}, 1).Empty());
  PointCloud same, broken = wall;
  same.points.assign(1000, {0, 0, 0});
  EXPECT_TRUE(FreeSpace(same, {Whole(same)}, 1).Empty());
  EXPECT_TRUE(FreeSpace(same, {Whole(same, {{0, 0, 0}})}, 1).Empty());
  for (size_t i = 0; i < 50; ++i) broken.points[97 * i].x() = nan;
  EXPECT_TRUE(FreeSpace(broken, {Whole(broken)}, 1).IsFree({5, 15, 25}));
  EXPECT_THROW(FreeSpace(wall, {{{kEye}, 0, 10001}}, 1), Error);
  EXPECT_THROW(FreeSpace(wall, {{{kEye}, 7, 3}}, 1), Error);
}

TEST(SightsOf, FollowTheScansInOrder) {
  ScanResult scan;
  scan.scans.resize(2);
  scan.scans[0] = {"a", Wall(), Pose()};
  scan.scans[1] = {"b", Wall(), Pose()};
  for (int i = 0; i < 2; ++i) {
    const PointCloud wall = Wall();
    scan.points.points.insert(scan.points.points.end(), wall.points.begin(), wall.points.end());
  }
  scan.rig.projector_from_camera.translation = {-100, 0, 0};
  scan.scans[1].camera_from_world = LookAt(kEye, {0, 0, 25}, Eigen::Vector3d::UnitZ());
  const std::vector<ScanSight> sights = SightsOf(scan);
  ASSERT_EQ(sights.size(), 2u);
  EXPECT_EQ(sights[0].first, 0);
  EXPECT_EQ(sights[0].last, 10000);
  ASSERT_EQ(sights[0].eyes.size(), 2u);
  EXPECT_EQ(sights[0].eyes[0], Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(sights[1].first, 10000);
  EXPECT_EQ(sights[1].last, 20000);
  ASSERT_EQ(sights[1].eyes.size(), 2u);
  EXPECT_NEAR((sights[1].eyes[0] - kEye).norm(), 0, 1e-9);
  EXPECT_NEAR((sights[1].eyes[1] - kEye).norm(), 100, 1e-9);
  scan.points.points.pop_back();
  EXPECT_TRUE(SightsOf(scan).empty());
}

}  // namespace
}  // namespace lfm
