// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/scan_rig.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;
constexpr double kDegree = std::numbers::pi / 180;

TEST(TroubleScanPoses, AreThePosesWithoutTrouble) {
  const std::vector<Pose> poses = MakeScanPoses(6, 20, 40);
  const std::vector<Pose> same = TroubleScanPoses(poses, 0, 0, 3);
  ASSERT_EQ(same.size(), poses.size());
  for (size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(same[i].rotation, poses[i].rotation);
    EXPECT_EQ(same[i].translation, poses[i].translation);
  }
}

// With the rig at one height, the platform's motion from one scan to the next is a turn about one
// axis, fixed in the room; it leans by the stated angle from the platform's normal.
TEST(TroubleScanPoses, TurnAboutOneLeaningAxis) {
  constexpr int kCount = 12;
  const std::vector<Pose> poses = TroubleScanPoses(MakeScanPoses(kCount, 30, 30), 2, 0, 3);
  const std::vector<Pose> plain = MakeScanPoses(kCount, 30, 30);
  EXPECT_LT(RotationAngle(poses[0].rotation, plain[0].rotation), 1e-12);
  for (int i = 1; i < kCount; ++i) {
    // In the platform's frame: from where it was at the first scan to where it is now.
    const Pose moved = poses[0].Inverse() * poses[static_cast<size_t>(i)];
    EXPECT_LT(moved.translation.norm(), 1e-9);
    const Eigen::AngleAxisd turn(moved.rotation);
    const double angle = 360.0 * i / kCount;
    EXPECT_NEAR(turn.angle() / kDegree, std::min(angle, 360 - angle), 1e-6);
    if (std::abs(angle - 180) < 1) continue;  // the axis' sign is open
    EXPECT_NEAR(std::acos(std::min(1.0, std::abs(turn.axis().z()))) / kDegree, 2, 1e-6);
    const Eigen::AngleAxisd first((poses[0].Inverse() * poses[1]).rotation);
    EXPECT_NEAR(std::abs(turn.axis().dot(first.axis())), 1, 1e-9);
  }
  // The same turn as on a good table.
  const Pose leant = poses[0].Inverse() * poses[3], good = plain[0].Inverse() * plain[3];
  EXPECT_LT(RotationAngle(leant.rotation, good.rotation), 3 * kDegree);
}

TEST(TroubleScanPoses, WobbleHasTheStatedSpreadInTheMiddleAndAtTheRim) {
  const std::vector<Pose> plain = MakeScanPoses(500, 30, 30);
  const std::vector<Pose> poses = TroubleScanPoses(plain, 0, 0.2, 3);
  double middle = 0, rim = 0;
  for (size_t i = 0; i < poses.size(); ++i) {
    const Pose wobble = plain[i].Inverse() * poses[i];
    middle += wobble.translation.squaredNorm() / 3 / 500;
    rim += std::pow((wobble * V3(100, 0, 0) - wobble.translation).z(), 2) / 500;
  }
  EXPECT_NEAR(std::sqrt(middle), 0.2, 0.015);
  EXPECT_NEAR(std::sqrt(rim), 0.2, 0.02);
}

}  // namespace
}  // namespace lfm
