// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/orbit_camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "synthetic_model.h"

namespace lfm {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFov = 30 * kPi / 180;

OrbitCamera TestOrbit() { return FrameMesh(MakeSphere(40, {10, 20, 60}, 2), kFov, 4.0 / 3); }

TEST(OrbitCamera, FramesTheWholeMeshWithAMargin) {
  const TriangleMesh mesh = MakeSphere(40, {10, 20, 60}, 3);
  for (const double aspect : {16.0 / 9, 1.0, 0.5}) {
    const OrbitCamera orbit = FrameMesh(mesh, kFov, aspect);
    const int height = 400, width = static_cast<int>(height * aspect);
    const Camera camera = PinholeCamera(orbit, width, height);
    const Pose pose = CameraFromWorld(orbit);
    double widest = 0;
    for (const Eigen::Vector3d& vertex : mesh.vertices) {
      const std::optional<Eigen::Vector2d> pixel = Project(camera, pose * vertex);
      ASSERT_TRUE(pixel && camera.Contains(*pixel));
      const Eigen::Vector2d off = *pixel - Eigen::Vector2d(camera.cx, camera.cy);
      widest = std::max(widest, off.norm() / (std::min(width, height) / 2.0));
    }
    EXPECT_NEAR(widest, 0.92, 0.01) << aspect;
  }
}

TEST(OrbitCamera, EyeStandsWhereAzimuthAndElevationSay) {
  OrbitCamera orbit = TestOrbit();
  orbit.target = {1, 2, 3};
  orbit.distance = 100;
  orbit.azimuth = kPi / 2;
  orbit.elevation = kPi / 6;
  const Pose pose = CameraFromWorld(orbit);
  EXPECT_LT((pose.Center() - Eigen::Vector3d(1, 2 + 100 * std::cos(kPi / 6), 53)).norm(), 1e-9);
  // The target is in the middle of the picture, and what lies above it is above it there.
  const Camera camera = PinholeCamera(orbit, 200, 100);
  const Eigen::Vector2d middle = Project(camera, pose * orbit.target).value();
  EXPECT_LT((middle - Eigen::Vector2d(99.5, 49.5)).norm(), 1e-9);
  const Eigen::Vector3d above = orbit.target + Eigen::Vector3d(0, 0, 5);
  const Eigen::Vector2d up = Project(camera, pose * above).value();
  EXPECT_NEAR(up.x(), 99.5, 1e-9);
  EXPECT_LT(up.y(), 45);
}

TEST(OrbitCamera, StaysInsideItsLimits) {
  OrbitCamera orbit = TestOrbit();
  orbit = Orbit(orbit, 100, 100);
  EXPECT_DOUBLE_EQ(orbit.elevation, OrbitCamera::kMaxElevation);
  EXPECT_GE(orbit.azimuth, 0);
  EXPECT_LT(orbit.azimuth, 2 * kPi);
  EXPECT_TRUE(CameraFromWorld(orbit).rotation.allFinite());
  orbit = Orbit(orbit, -1000, -100);
  EXPECT_DOUBLE_EQ(orbit.elevation, -OrbitCamera::kMaxElevation);
  EXPECT_GE(orbit.azimuth, 0);
  EXPECT_DOUBLE_EQ(Zoom(orbit, 1e-9).distance, orbit.min_distance);
  EXPECT_DOUBLE_EQ(Zoom(orbit, 1e9).distance, orbit.max_distance);
  const OrbitCamera far = Pan(orbit, {1e7, -1e7}, 100);
  EXPECT_LE((far.target - far.scene_center).norm(), far.scene_radius * (1 + 1e-12));
}

TEST(OrbitCamera, IgnoresWhatIsNotANumber) {
  const OrbitCamera orbit = TestOrbit();
  const double nan = std::nan(""), infinity = HUGE_VAL;
  for (const double bad : {nan, infinity, -infinity}) {
    EXPECT_EQ(Orbit(orbit, bad, bad).azimuth, orbit.azimuth);
    EXPECT_EQ(Orbit(orbit, bad, bad).elevation, orbit.elevation);
    EXPECT_EQ(Zoom(orbit, bad).distance, orbit.distance);
    EXPECT_EQ(Pan(orbit, {bad, 0}, 100).target, orbit.target);
  }
  EXPECT_EQ(Zoom(orbit, 0).distance, orbit.distance);
  EXPECT_EQ(Zoom(orbit, -2).distance, orbit.distance);
  EXPECT_EQ(Pan(orbit, {1, 1}, 0).target, orbit.target);
}

TEST(OrbitCamera, PanCarriesTheTargetWithThePointer) {
  const OrbitCamera orbit = TestOrbit();
  const OrbitCamera panned = Pan(orbit, {12, -7}, 480);
  const Camera camera = PinholeCamera(orbit, 640, 480);
  // What lay in the middle is seen where the pointer went.
  const Eigen::Vector2d pixel = Project(camera, CameraFromWorld(panned) * orbit.target).value();
  EXPECT_LT((pixel - Eigen::Vector2d(319.5 + 12, 239.5 - 7)).norm(), 1e-6);
}

TEST(OrbitCamera, TurntableGoesOnceRoundInEqualSteps) {
  OrbitCamera start = TestOrbit();
  start.azimuth = 5.5;
  const int frames = 12;
  const std::vector<OrbitCamera> path = TurntablePath(start, frames);
  ASSERT_EQ(path.size(), 12u);
  EXPECT_EQ(path[0].azimuth, start.azimuth);
  const double step = 2 * kPi / frames;
  for (int i = 0; i < frames; ++i) {
    const Eigen::Vector3d eye = CameraFromWorld(path[i]).Center() - start.target;
    const Eigen::Vector3d next = CameraFromWorld(path[(i + 1) % frames]).Center() - start.target;
    EXPECT_NEAR(eye.norm(), start.distance, 1e-9);
    EXPECT_NEAR(eye.z(), next.z(), 1e-9);
    const double turn = std::atan2(eye.x() * next.y() - eye.y() * next.x(),
                                   eye.x() * next.x() + eye.y() * next.y());
    EXPECT_NEAR(turn, step, 1e-9) << i;
  }
  EXPECT_EQ(TurntablePath(start, 1).size(), 1u);
  EXPECT_THROW(TurntablePath(start, 0), Error);
}

TEST(OrbitCamera, FramesPointsAndRejectsNothing) {
  TriangleMesh point;
  point.vertices = {{3, 4, 5}, {3, 4, 5}, {3, 4, 5}};
  const OrbitCamera orbit = FrameMesh(point, kFov, 1);
  EXPECT_EQ(orbit.target, Eigen::Vector3d(3, 4, 5));
  EXPECT_GT(orbit.distance, 0);
  EXPECT_THROW(FrameMesh(TriangleMesh(), kFov, 1), Error);
  EXPECT_THROW(FrameMesh(point, 0, 1), Error);
  EXPECT_THROW(FrameMesh(point, std::nan(""), 1), Error);
  EXPECT_THROW(FrameMesh(point, kFov, 0), Error);
}

}  // namespace
}  // namespace lfm
