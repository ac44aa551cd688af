// SPDX-License-Identifier: BSD-3-Clause
#include "calib/bundle_adjustment.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/board.h"
#include "calib/corner_refinement.h"
#include "core/error.h"
#include "core/process_memory.h"
#include "rendered_board.h"
#include "simulated_views.h"

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

// World coordinates may begin anywhere: ten metres away, the same cameras see the same.
TEST(BundleAdjustment, TenMetresAwayNothingChanges) {
  constexpr double kRounding_abs_mm = 1e-4;
  const Camera truth = SmallCamera();
  const Eigen::Vector3d far(10000, -10000, 10000);
  std::vector<BundleView> near_views =
      SimulatedViews(truth, PosesAround(6), DefaultBoard(), 0.1, 1);
  std::vector<BundleView> far_views = near_views;
  for (size_t v = 0; v < far_views.size(); ++v) {
    near_views[v].camera_from_world = Disturbed(near_views[v].camera_from_world, 0.1);
    far_views[v].camera_from_world =
        near_views[v].camera_from_world * Pose{Eigen::Matrix3d::Identity(), -far};
    for (Eigen::Vector3d& p : far_views[v].points) p += far;
  }
  const BundleResult a = AdjustBundle(truth, near_views, {});
  const BundleResult b = AdjustBundle(truth, far_views, {});
  EXPECT_NEAR(a.camera.fx, b.camera.fx, 1e-5);
  EXPECT_NEAR(a.camera.cx, b.camera.cx, 1e-5);
  for (size_t v = 0; v < a.poses.size(); ++v) {
    EXPECT_LT((a.poses[v].Center() + far - b.poses[v].Center()).norm(), kRounding_abs_mm);
    EXPECT_LT(RotationAngle(a.poses[v].rotation, b.poses[v].rotation), 1e-7);
  }
}

// Poses are eliminated view by view, so thousands of photographs cost their corners' time and
// little memory: of the order of a kilobyte a view.
TEST(BundleAdjustment, FiveThousandPhotographsFitInLittleMemory) {
  constexpr int kPhotos = 5000;
  Board board = DefaultBoard();
  board.checker_columns = board.checker_rows = 0;
  const Camera truth = SmallCamera();
  const std::vector<Pose> poses = PosesAround(kPhotos);
  std::vector<BundleView> views = SimulatedViews(truth, poses, board, 0.1, 1);
  for (BundleView& view : views) view.camera_from_world = Disturbed(view.camera_from_world, 0.05);
  const double before_mib = PeakMemoryMib();
  const BundleResult result = AdjustBundle(PlainStart(truth), views, {.lens_terms = 4});
  EXPECT_LT(PeakMemoryMib() - before_mib, 128);
  EXPECT_NEAR(result.camera.fx, truth.fx, 0.02);
  EXPECT_NEAR(result.camera.cx, truth.cx, 0.02);
  std::vector<double> errors;
  for (int v = 0; v < kPhotos; ++v) {
    errors.push_back((result.poses[v].Center() - poses[v].Center()).norm());
  }
  std::nth_element(errors.begin(), errors.begin() + kPhotos / 2, errors.end());
  EXPECT_LT(errors[kPhotos / 2], 0.1);
}

TEST(BundleAdjustment, RationalLensIsRecovered) {
  Camera truth = SmallCamera();
  truth.k1 = 0.4, truth.k2 = -0.2, truth.p1 = truth.p2 = 0;
  truth.k4 = 0.7, truth.k5 = 0.1, truth.k6 = 0.05;
  const std::vector<BundleView> views = ExactViews(truth, PosesAround(8));
  const BundleResult result =
      AdjustBundle(PlainStart(truth), views, {.lens_terms = kAllLensTerms, .robust_scale_px = 5});
  // The coefficients trade with each other: compare the lens where it was used.
  for (const double x : {-0.35, 0.0, 0.35}) {
    for (const double y : {-0.25, 0.0, 0.25}) {
      const Eigen::Vector3d ray(x, y, 1);
      EXPECT_LT((*Project(result.camera, ray) - *Project(truth, ray)).norm(), 0.01) << x << y;
    }
  }
}

// A phone and a camera with a lens of its own, one of them known, over one platform.
TEST(BundleAdjustment, CamerasAreAdjustedTogetherAndKnownOnesHeld) {
  const Camera one = SmallCamera();
  Camera other = SmallCamera();
  other.fx = other.fy = 610, other.k1 = 0.05;
  const std::vector<Pose> poses = PosesAround(8);
  JointBundle bundle{
      {{PlainStart(one), FreeIntrinsics::kAll, 4}, {other, FreeIntrinsics::kNone, 0}}, {}};
  for (int v = 0; v < 8; ++v) {
    const std::vector<BundleView> view =
        SimulatedViews(v % 2 ? other : one, {poses[v]}, DefaultBoard(), 0.02, 3 + v);
    bundle.views.push_back(view[0]);
    bundle.views.back().camera = v % 2;
    bundle.views.back().camera_from_world = Disturbed(poses[v], 0.2);
  }
  const JointResult result = AdjustJointly(bundle, 0.5, 100);
  EXPECT_NEAR(result.cameras[0].fx, one.fx, 0.3);
  EXPECT_EQ(result.cameras[1].fx, other.fx);
  EXPECT_EQ(result.cameras[1].k1, other.k1);
  for (int v = 0; v < 8; ++v) {
    EXPECT_LT((result.poses[v].Center() - poses[v].Center()).norm(), 0.3) << v;
  }
}

}  // namespace
}  // namespace lfm
