// SPDX-License-Identifier: BSD-3-Clause
#include "scan/registration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/parallel.h"
#include "scan/triangulate.h"
#include "tests/scan/synthetic_rig.h"

namespace lfm {
namespace {

using testing::HitPlate;
using testing::HitSphere;
using testing::SurfaceHit;
using testing::TurnedPlatform;

constexpr double kSigmaMm = 0.02;

/// Three balls of different sizes on the plate: no motion leaves them alike.
std::optional<SurfaceHit> Balls(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  std::optional<SurfaceHit> nearest = HitPlate(origin, direction);
  for (const auto& [center, radius] : {std::pair{Eigen::Vector3d(30, 0, 25), 25.0},
                                       {Eigen::Vector3d(-30, 15, 18), 18.0},
                                       {Eigen::Vector3d(-5, -35, 12), 12.0}}) {
    const auto hit = HitSphere(origin, direction, center, radius);
    if (hit && (!nearest || hit->distance < nearest->distance)) nearest = hit;
  }
  return nearest;
}

struct PoseNoise {
  double mm = 0, rad = 0;
};

struct Scans {
  Camera camera = testing::KnownRig(false).camera;
  std::vector<Eigen::Vector2d> rays = NormalizedRays(camera);
  std::vector<Pose> truth;
  std::vector<PosedRange> ranges;  ///< at poses that are off
  std::vector<Eigen::Matrix<double, 6, 6>> covariances;
};

/// `count` scans of the balls all round, their depths with noise, their poses off by `noise`; the
/// world lies at `offset_mm` from the platform.
Scans MakeScans(int count, const PoseNoise& noise, const Eigen::Vector3d& offset_mm = {0, 0, 0}) {
  Scans scans;
  std::mt19937 random(11);
  std::normal_distribution<double> normal(0, 1);
  const auto three = [&] {
    return Eigen::Vector3d(normal(random), normal(random), normal(random));
  };
  for (int i = 0; i < count; ++i) {
    const Pose pose = TurnedPlatform(360.0 * i / count);
    PosedRange range;
    range.map.width = scans.camera.width;
    range.map.height = scans.camera.height;
    const Pose world_from_camera = pose.Inverse();
    for (const Eigen::Vector2d& ray : scans.rays) {
      const Eigen::Vector3d in_camera = ray.homogeneous();
      const Eigen::Vector3d direction = (world_from_camera.rotation * in_camera).normalized();
      const auto hit = Balls(pose.Center(), direction);
      const double depth = hit ? hit->distance / in_camera.norm() : 0;
      const Eigen::Vector3d n =
          hit ? Eigen::Vector3d(pose.rotation * hit->normal) : Eigen::Vector3d::Zero();
      const double seen = -n.dot(in_camera.normalized());
      const bool kept = hit && seen > 0.3;
      range.map.depth.push_back(kept ? depth + kSigmaMm * normal(random) / seen : 0);
      range.map.normal.push_back(n.cast<float>());
      range.map.confidence.push_back(kept ? 0.9F : 0.0F);
      range.map.sigma_mm.push_back(kept ? static_cast<float>(kSigmaMm) : 0.0F);
    }
    const Eigen::Vector3d turn = noise.rad * three();
    const Pose world_from_platform{Eigen::Matrix3d::Identity(), offset_mm};
    const Pose true_pose = pose * world_from_platform.Inverse();
    scans.truth.push_back(true_pose);
    Pose off = pose;
    off.rotation =
        Eigen::AngleAxisd(turn.norm() + 1e-300, (turn + Eigen::Vector3d(0, 0, 1e-300)).normalized())
            .toRotationMatrix() *
        pose.rotation;
    off.translation += noise.mm * three();
    range.camera_from_world = off * world_from_platform.Inverse();
    scans.ranges.push_back(range);
    Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
    covariance.diagonal() << Eigen::Vector3d::Constant(noise.rad * noise.rad),
        Eigen::Vector3d::Constant(noise.mm * noise.mm);
    // In the parameters of the offset pose, a turn moves the world's origin too.
    Eigen::Matrix<double, 6, 6> change = Eigen::Matrix<double, 6, 6>::Identity();
    const Eigen::Vector3d arm = true_pose.translation - pose.translation;
    change.block<3, 3>(3, 0) << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
    scans.covariances.push_back(change * covariance * change.transpose());
  }
  return scans;
}

Registration Register(const Scans& scans) {
  return RegisterScans(scans.ranges, scans.covariances, scans.camera, scans.rays, {},
                       SilentProgress());
}

/// Mean distance, mm, of the balls' and the plate's middle from where they are, over the scans,
/// after the motion that all scans have in common is taken out by the first scan.
double RelativeError(const Scans& scans, const std::vector<Pose>& poses) {
  double sum = 0;
  const Pose common = scans.truth[0].Inverse() * poses[0];
  for (size_t i = 1; i < poses.size(); ++i) {
    const Pose own = scans.truth[i].Inverse() * poses[i];
    for (const Eigen::Vector3d& p :
         {Eigen::Vector3d(30, 0, 25), Eigen::Vector3d(-30, 15, 18), Eigen::Vector3d(0, 0, 0)}) {
      const Eigen::Vector3d in_world = scans.truth[i].Inverse() * (TurnedPlatform(0) * p);
      sum += (own * in_world - common * in_world).norm();
    }
  }
  return sum / (3.0 * static_cast<double>(poses.size() - 1));
}

TEST(Registration, BringsScansThatAreOffTogether) {
  const Scans scans = MakeScans(6, {0.2, 5e-4});
  const Registration found = Register(scans);
  EXPECT_TRUE(found.report.kept);
  EXPECT_GE(found.report.pairs, 6);
  EXPECT_GT(found.report.held_out, 1000);
  EXPECT_LT(found.report.after_mm, found.report.before_mm);
  // Two surfaces of noise kSigmaMm each.
  EXPECT_LT(found.report.after_mm, 2.5 * kSigmaMm);
  std::vector<Pose> before;
  for (const PosedRange& r : scans.ranges) before.push_back(r.camera_from_world);
  EXPECT_LT(RelativeError(scans, found.poses), 0.15 * RelativeError(scans, before));
}

TEST(Registration, PosesThatAreRightAreNotMadeWorse) {
  const Scans scans = MakeScans(6, {0, 0});
  const Registration found = Register(scans);
  const double after = found.report.kept ? found.report.after_mm : found.report.before_mm;
  EXPECT_LE(after, found.report.before_mm);
  EXPECT_LT(RelativeError(scans, found.poses), 0.01);
}

TEST(Registration, OneScanAndScansThatDoNotOverlapKeepTheirPoses) {
  const Scans one = MakeScans(1, {0.2, 5e-4});
  const Registration alone = Register(one);
  EXPECT_FALSE(alone.report.kept);
  EXPECT_EQ(alone.report.pairs, 0);
  EXPECT_EQ(alone.poses[0].translation, one.ranges[0].camera_from_world.translation);

  Scans apart = MakeScans(2, {0.2, 5e-4});
  apart.ranges[1].camera_from_world.translation.x() += 1000;
  const Registration found = Register(apart);
  EXPECT_FALSE(found.report.kept);
  EXPECT_EQ(found.poses[1].translation, apart.ranges[1].camera_from_world.translation);
  EXPECT_TRUE(RegisterScans({}, {}, apart.camera, apart.rays, {}, SilentProgress()).poses.empty());
}

TEST(Registration, AWorldTenMetresAwayChangesNothing) {
  const Scans near = MakeScans(4, {0.2, 5e-4});
  const Scans far = MakeScans(4, {0.2, 5e-4}, {10000, -10000, 10000});
  const Registration a = Register(near), b = Register(far);
  EXPECT_TRUE(b.report.kept);
  EXPECT_NEAR(a.report.after_mm, b.report.after_mm, 1e-3);
  EXPECT_NEAR(RelativeError(near, a.poses), RelativeError(far, b.poses), 0.01);
}

TEST(Registration, TheNumberOfThreadsDoesNotMatter) {
  const Scans scans = MakeScans(3, {0.1, 2e-4});
  SetThreadCount(1);
  const Registration one = Register(scans);
  SetThreadCount(4);
  const Registration four = Register(scans);
  SetThreadCount(0);
  for (size_t i = 0; i < one.poses.size(); ++i) {
    EXPECT_EQ(one.poses[i].translation, four.poses[i].translation);
    EXPECT_EQ(one.poses[i].rotation, four.poses[i].rotation);
  }
}

}  // namespace
}  // namespace lfm
