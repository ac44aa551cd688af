// SPDX-License-Identifier: BSD-3-Clause
#include "calib/bundle_adjustment.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "calib/board.h"
#include "calib/corner_refinement.h"
#include "core/error.h"
#include "rendered_board.h"

namespace lfm {
namespace {

constexpr double kExactIntrinsics_rel = 1e-6;
constexpr double kExactPose_abs = 1e-6;

std::vector<BundleView> ExactViews(const Camera& camera, const std::vector<Pose>& poses) {
  std::vector<BundleView> views;
  for (const Pose& pose : poses) {
    BundleView view{pose, {}, {}};
    for (const Eigen::Vector3d& corner : BoardCorners(DefaultBoard())) {
      const auto pixel = Project(camera, pose * corner);
      if (!pixel || !camera.Contains(*pixel)) continue;
      view.points.push_back(corner);
      view.pixels.push_back(*pixel);
    }
    views.push_back(view);
  }
  return views;
}

Pose Disturbed(const Pose& pose, double amount) {
  const Eigen::Vector3d axis(0.4, -0.7, 0.5);
  return Pose{Eigen::AngleAxisd(0.05 * amount, axis.normalized()).toRotationMatrix(),
              amount * Eigen::Vector3d(6, -4, 9)} *
         pose;
}

Camera PlainStart(const Camera& truth) {
  Camera start;
  start.width = truth.width, start.height = truth.height;
  start.fx = start.fy = 560;
  start.cx = (truth.width - 1) / 2.0, start.cy = (truth.height - 1) / 2.0;
  return start;
}

TEST(BundleAdjustment, RecoversParametersFromExactCorners) {
  const Camera truth = SmallCamera();
  const std::vector<Pose> poses = PosesAround(8);
  std::vector<BundleView> views = ExactViews(truth, poses);
  for (BundleView& view : views) view.camera_from_world = Disturbed(view.camera_from_world, 1);
  const BundleResult result = AdjustBundle(PlainStart(truth), views, {.robust_scale_px = 5});
  const Camera& c = result.camera;
  EXPECT_NEAR(c.fx, truth.fx, kExactIntrinsics_rel * truth.fx);
  EXPECT_NEAR(c.fy, truth.fy, kExactIntrinsics_rel * truth.fy);
  EXPECT_NEAR(c.cx, truth.cx, kExactIntrinsics_rel * truth.cx);
  EXPECT_NEAR(c.cy, truth.cy, kExactIntrinsics_rel * truth.cy);
  for (const auto& [found, expected] :
       {std::pair(c.k1, truth.k1), std::pair(c.k2, truth.k2), std::pair(c.k3, truth.k3),
        std::pair(c.p1, truth.p1), std::pair(c.p2, truth.p2)}) {
    EXPECT_NEAR(found, expected, kExactIntrinsics_rel);
  }
  for (size_t i = 0; i < poses.size(); ++i) {
    EXPECT_LT((result.poses[i].Center() - poses[i].Center()).norm(), 300 * kExactPose_abs);
    EXPECT_LT(RotationAngle(result.poses[i].rotation, poses[i].rotation), kExactPose_abs);
  }
}

TEST(BundleAdjustment, OutliersDoNotPull) {
  const Camera truth = SmallCamera();
  const std::vector<Pose> poses = PosesAround(6);
  std::vector<BundleView> views = ExactViews(truth, poses);
  for (BundleView& view : views) {
    for (size_t i = 0; i < view.pixels.size(); i += 6) view.pixels[i] += Eigen::Vector2d(25, -18);
    view.camera_from_world = Disturbed(view.camera_from_world, 0.2);
  }
  const BundleResult result = AdjustBundle(truth, views, {.robust_scale_px = 0.1});
  EXPECT_NEAR(result.camera.fx, truth.fx, 0.05);
  for (size_t i = 0; i < poses.size(); ++i) {
    EXPECT_LT((result.poses[i].Center() - poses[i].Center()).norm(), 0.05);
  }
}

TEST(BundleAdjustment, PoseAloneFromExactCorners) {
  const Camera camera = SmallCamera();
  const Pose pose = PosesAround(5)[3];
  BundleView view = ExactViews(camera, {pose})[0];
  view.camera_from_world = Disturbed(pose, 1);
  const Pose found = AdjustPose(camera, view, 1);
  EXPECT_LT((found.Center() - pose.Center()).norm(), 300 * kExactPose_abs);
  EXPECT_LT(RotationAngle(found.rotation, pose.rotation), kExactPose_abs);
}

TEST(BundleAdjustment, PointsBehindTheCameraCostAndComeForward) {
  const Camera camera = SmallCamera();
  const Pose pose = LookAt({0, -10, 330}, {0, 0, 0}, {0, 1, 0});
  BundleView view = ExactViews(camera, {pose})[0];
  view.camera_from_world.translation.z() = -40;
  for (const auto& error : ReprojectionErrors(camera, view)) EXPECT_FALSE(error);
  const Pose found = AdjustPose(camera, view, 1000);
  EXPECT_LT((found.Center() - pose.Center()).norm(), 1e-3);
}

TEST(BundleAdjustment, EmptyViewsKeepTheirPose) {
  const Camera camera = SmallCamera();
  const Pose pose = PosesAround(3)[1];
  const BundleView empty{pose, {}, {}};
  EXPECT_EQ(AdjustPose(camera, empty, 1).translation, pose.translation);
  const BundleResult result = AdjustBundle(camera, {empty}, {});
  EXPECT_EQ(result.poses.at(0).translation, pose.translation);
  EXPECT_EQ(result.camera.fx, camera.fx);
  EXPECT_TRUE(AdjustBundle(camera, {}, {}).poses.empty());
}

TEST(BundleAdjustment, RefusesAStartThatIsNotFinite) {
  const Camera camera = SmallCamera();
  BundleView view = ExactViews(camera, PosesAround(1))[0];
  view.pixels[0].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(AdjustPose(camera, view, 1), Error);
  EXPECT_THROW(AdjustBundle(camera, {view}, {}), Error);
}

// Pose errors over many draws of corner noise, measured in their own covariance, must follow
// chi-squared with six degrees of freedom.
TEST(BundleAdjustment, PoseCovarianceIsHonest) {
  constexpr double kNoisePx = 0.3;
  constexpr int kDraws = 200;
  const Camera camera = SmallCamera();
  const Pose pose = PosesAround(5)[1];
  const BundleView exact = ExactViews(camera, {pose})[0];
  const Eigen::MatrixXd covariance =
      CovarianceFromInformation(ComputeInformation(camera, {exact}).poses[0], kNoisePx * kNoisePx);
  const Eigen::MatrixXd precision = covariance.inverse();
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, kNoisePx);
  double chi2 = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    BundleView view = exact;
    for (Eigen::Vector2d& p : view.pixels) p += Eigen::Vector2d(noise(random), noise(random));
    const Pose found = AdjustPose(camera, view, 100);
    const Eigen::AngleAxisd turn(found.rotation * pose.rotation.transpose());
    Eigen::Matrix<double, 6, 1> error;
    error << turn.angle() * turn.axis(), found.translation - pose.translation;
    chi2 += error.dot(precision * error) / (6.0 * kDraws);
  }
  EXPECT_GT(chi2, 0.85);
  EXPECT_LT(chi2, 1.18);
}

TEST(BundleAdjustment, FocalLengthIsKnownFromSlantedViewsOnly) {
  const Camera camera = SmallCamera();
  const auto focal_sigma = [&](const std::vector<Pose>& poses) {
    return std::sqrt(CovarianceFromInformation(
        ComputeInformation(camera, ExactViews(camera, poses)).intrinsics, 0.01)(0, 0));
  };
  std::vector<Pose> head_on;
  for (double z : {320, 330, 340}) {
    head_on.push_back(LookAt({0, 0, z}, {0, 0, 0}, {0, 1, 0}));
  }
  EXPECT_LT(focal_sigma(PosesAround(6)), 0.002 * camera.fx);
  EXPECT_GT(focal_sigma(head_on), 0.05 * camera.fx);
}

TEST(BundleAdjustment, CovarianceOfNothingIsLargeButFinite) {
  const Eigen::MatrixXd none = CovarianceFromInformation(Eigen::MatrixXd::Zero(6, 6), 1);
  EXPECT_TRUE(none.allFinite());
  EXPECT_GE(none(0, 0), 1e12);
  Eigen::MatrixXd half = Eigen::MatrixXd::Zero(2, 2);
  half(0, 0) = 4;
  const Eigen::MatrixXd covariance = CovarianceFromInformation(half, 1);
  EXPECT_TRUE(covariance.allFinite());
  EXPECT_NEAR(covariance(0, 0), 0.25, 1e-12);
  EXPECT_GE(covariance(1, 1), 1e11);  // an unknown of which nothing is said is not certain
  // Two unknowns of which only the sum is said.
  const Eigen::MatrixXd sum = CovarianceFromInformation(Eigen::MatrixXd::Ones(2, 2), 0.01);
  EXPECT_NEAR(sum.sum(), 0.01, 1e-4);
  EXPECT_GE(sum(0, 0), 1e9);
}

}  // namespace
}  // namespace lfm
