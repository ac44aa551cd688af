// SPDX-License-Identifier: BSD-3-Clause
#include "core/pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "test_files.h"

namespace lfm {
namespace {

Eigen::Matrix3d Turn(double angle, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

TEST(Pose, ComposesAndInverts) {
  const Pose c_from_b{Turn(0.7, {1, 2, 3}), {10, -20, 30}};
  const Pose b_from_a{Turn(-1.9, {0, 1, -1}), {0.5, 4, -7}};
  const Eigen::Vector3d p(3, -2, 11);
  EXPECT_LT(((c_from_b * b_from_a) * p - c_from_b * (b_from_a * p)).norm(), 1e-12);
  EXPECT_LT((c_from_b.Inverse() * (c_from_b * p) - p).norm(), 1e-12);
  EXPECT_LT((c_from_b * c_from_b.Center()).norm(), 1e-12);
}

// Quaternions are w, x, y, z: a quarter turn about z is (sqrt(1/2), 0, 0, sqrt(1/2)) and takes x
// to y.
TEST(Pose, QuaternionIsHamiltonsWithPositiveW) {
  const double h = std::sqrt(0.5);
  const Pose pose = Pose::FromQuaternion(Eigen::Quaterniond(-2 * h, 0, 0, -2 * h), {1, 2, 3});
  EXPECT_LT((pose * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(), 1e-15);
  const Eigen::Quaterniond q = pose.Quaternion();
  EXPECT_NEAR(q.w(), h, 1e-15);
  EXPECT_NEAR(q.z(), h, 1e-15);
  const Eigen::Quaterniond half_turn =
      Pose::FromQuaternion(Eigen::Quaterniond(0, 0, -1, 0), {0, 0, 0}).Quaternion();
  EXPECT_NEAR(std::abs(half_turn.y()), 1, 1e-15);
  EXPECT_NEAR(half_turn.norm(), 1, 1e-15);
}

TEST(Pose, RefusesImpossibleQuaternions) {
  ExpectError([] { Pose::FromQuaternion(Eigen::Quaterniond(0, 0, 0, 0), {0, 0, 0}); }, "pose");
  ExpectError(
      [] {
        Pose::FromQuaternion(Eigen::Quaterniond(std::nan(""), 0, 0, 1), {0, 0, 0});
      },
      "pose");
  ExpectError(
      [] {
        Pose::FromQuaternion(Eigen::Quaterniond(1, 0, 0, 0), {0, std::nan(""), 0});
      },
      "pose");
}

TEST(RotationAngle, IsAccurateFromZeroToPi) {
  const Eigen::Matrix3d start = Turn(1.1, {3, 1, 2});
  for (const double angle : {0.0, 1e-12, 1e-9, 1e-5, 0.3, 1.5, 3.0, std::numbers::pi}) {
    EXPECT_NEAR(RotationAngle(start, start * Turn(angle, {1, -1, 0.5})), angle, 1e-12) << angle;
  }
}

TEST(LookAt, PutsTheTargetInTheMiddleAndUpUpwards) {
  const Eigen::Vector3d eye(300, -100, 200), target(1, 2, 40);
  const Pose pose = LookAt(eye, target, {0, 0, 1});
  EXPECT_LT((pose.Center() - eye).norm(), 1e-10);
  const Eigen::Vector3d ahead = pose * target;
  EXPECT_NEAR(ahead.x(), 0, 1e-10);
  EXPECT_NEAR(ahead.y(), 0, 1e-10);
  EXPECT_NEAR(ahead.z(), (target - eye).norm(), 1e-10);
  // y points down in the picture: what is higher in the world has smaller y.
  EXPECT_LT((pose * (target + Eigen::Vector3d(0, 0, 10))).y(), -1);
  EXPECT_LT((pose.rotation * pose.rotation.transpose() - Eigen::Matrix3d::Identity()).norm(),
            1e-14);
  EXPECT_NEAR(pose.rotation.determinant(), 1, 1e-14);
}

TEST(LookAt, RefusesDegenerateViews) {
  ExpectError([] { LookAt({1, 2, 3}, {1, 2, 3}, {0, 0, 1}); }, "look-at");
  ExpectError([] { LookAt({0, 0, 9}, {0, 0, 0}, {0, 0, 1}); }, "look-at");
  ExpectError([] { LookAt({0, 0, 9}, {0, 0, std::nan("")}, {0, 1, 0}); }, "look-at");
}

}  // namespace
}  // namespace lfm
