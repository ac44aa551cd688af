// SPDX-License-Identifier: BSD-3-Clause
#include "scan/turntable.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/scan/synthetic_rig.h"

namespace lfm {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

struct TableNoise {
  double mm = 0, rad = 0;
};

/// A platform turned in equal steps about an axis that leans from its normal, before a resting rig.
std::vector<PoseEstimate> TurnedPoses(int count, double lean_deg, const TableNoise& noise,
                                      uint32_t seed, const Pose& first) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1);
  const Eigen::Vector3d axis =
      Eigen::AngleAxisd(lean_deg * kDegree, Eigen::Vector3d(1, 0.3, 0).normalized()) *
      Eigen::Vector3d::UnitZ();
  std::vector<PoseEstimate> poses;
  for (int i = 0; i < count; ++i) {
    const Pose turn{Eigen::AngleAxisd(2 * std::numbers::pi * i / count, axis).toRotationMatrix(),
                    Eigen::Vector3d::Zero()};
    Pose pose = first * turn;
    Eigen::Vector3d off(normal(random), normal(random), normal(random));
    off *= noise.rad;
    pose.rotation =
        Eigen::AngleAxisd(off.norm() + 1e-300, (off + Eigen::Vector3d(0, 0, 1e-300)).normalized())
            .toRotationMatrix() *
        pose.rotation;
    pose.translation += noise.mm * Eigen::Vector3d(normal(random), normal(random), normal(random));
    PoseEstimate estimate{pose};
    estimate.covariance.diagonal() << Eigen::Vector3d::Constant(1e-14 + noise.rad * noise.rad),
        Eigen::Vector3d::Constant(1e-10 + noise.mm * noise.mm);
    poses.push_back(estimate);
  }
  return poses;
}

TEST(Turntable, AxisThatLeansIsFound) {
  const Pose first = testing::TurnedPlatform(0);
  for (double lean_deg : {0.0, 4.0}) {
    const auto poses = TurnedPoses(9, lean_deg, {}, 1, first);
    const auto runs = FindTurntableRuns(poses, TurntableUse::kAuto);
    ASSERT_EQ(runs.size(), 1U);
    EXPECT_EQ(runs[0].members.size(), 9U);
    EXPECT_LT(runs[0].rms_mm, 1e-5);
    const Eigen::Vector3d axis =
        first.rotation *
        (Eigen::AngleAxisd(lean_deg * kDegree, Eigen::Vector3d(1, 0.3, 0).normalized()) *
         Eigen::Vector3d::UnitZ());
    EXPECT_GT(std::abs(runs[0].direction.dot(axis)), 1 - 1e-12);
    // The platform's origin rests: the axis goes through it.
    EXPECT_LT((runs[0].point - first.translation).norm(), 1e-4);
    EXPECT_NEAR(std::abs(std::remainder(runs[0].angles[1] - runs[0].angles[0], 2 * M_PI)),
                2 * std::numbers::pi / 9, 1e-8);
  }
}

TEST(Turntable, NoiseOfTheStatedSizeIsSupportedAndAWobbleIsNot) {
  const TableNoise noise{0.02, 1e-4};
  int supported = 0;
  for (uint32_t seed = 1; seed <= 20; ++seed) {
    const auto poses = TurnedPoses(9, 2, noise, seed, testing::TurnedPlatform(0));
    const auto runs = FindTurntableRuns(poses, TurntableUse::kAuto);
    supported += runs.size() == 1 && runs[0].members.size() == 9 ? 1 : 0;
  }
  EXPECT_GE(supported, 18);

  auto wobbling = TurnedPoses(9, 2, {0.2, 1e-3}, 3, testing::TurnedPlatform(0));
  for (PoseEstimate& p : wobbling) {
    p.covariance.diagonal() << Eigen::Vector3d::Constant(1e-8), Eigen::Vector3d::Constant(4e-4);
  }
  EXPECT_TRUE(FindTurntableRuns(wobbling, TurntableUse::kAuto).empty());
  EXPECT_FALSE(FindTurntableRuns(wobbling, TurntableUse::kOn).empty());
  EXPECT_TRUE(FindTurntableRuns(wobbling, TurntableUse::kOff).empty());
}

TEST(Turntable, TwoHeightsOfTheRigAreTwoRuns) {
  const TableNoise noise{0.01, 5e-5};
  const Pose high = testing::TurnedPlatform(0);
  const Pose low = LookAt({0, -500, 150}, {0, 0, 30}, {0, 0, 1});
  const auto a = TurnedPoses(9, 0, noise, 1, high), b = TurnedPoses(9, 0, noise, 2, low);
  std::vector<PoseEstimate> poses;
  for (size_t i = 0; i < a.size(); ++i) {
    poses.push_back(a[i]);
    poses.push_back(b[i]);
  }
  const auto runs = FindTurntableRuns(poses, TurntableUse::kAuto);
  ASSERT_EQ(runs.size(), 2U);
  for (const TurntableRun& run : runs) {
    ASSERT_EQ(run.members.size(), 9U);
    for (int m : run.members) EXPECT_EQ(m % 2, run.members[0] % 2);
  }
}

TEST(Turntable, FewOrRestingOrUnrelatedPosesMakeNoRun) {
  EXPECT_TRUE(FindTurntableRuns({}, TurntableUse::kOn).empty());
  const auto three = TurnedPoses(3, 0, {}, 1, testing::TurnedPlatform(0));
  EXPECT_TRUE(FindTurntableRuns(three, TurntableUse::kOn).empty());
  const std::vector<PoseEstimate> resting(6, PoseEstimate{testing::TurnedPlatform(10)});
  EXPECT_TRUE(FindTurntableRuns(resting, TurntableUse::kOn).empty());
  std::vector<PoseEstimate> tilted;
  for (const Pose& pose : testing::TiltedPlacements()) tilted.push_back({pose});
  EXPECT_TRUE(FindTurntableRuns(tilted, TurntableUse::kAuto).empty());
}

}  // namespace
}  // namespace lfm
