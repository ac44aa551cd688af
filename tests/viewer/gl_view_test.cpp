// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/gl_view.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/error.h"

namespace lfm {
namespace {

constexpr double kSphere_rel = 1e-12;
constexpr double kClip_abs = 1e-5;  // in [-1, 1], single precision

Camera TestCamera() {
  Camera camera;
  camera.width = 200;
  camera.height = 160;
  camera.fx = 310;
  camera.fy = 290;
  camera.cx = 104.2;
  camera.cy = 76.7;
  return camera;
}

Pose TestPose() { return LookAt({260, -190, 150}, {3, 5, -2}, {0.1, 0.2, 1}); }

Placement TestPlacement() {
  Placement placement;
  placement.world_from_model.rotation =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  placement.world_from_model.translation = {30, -40, 15};
  placement.scale = 0.6;
  return placement;
}

class Random {
 public:
  Eigen::Vector3d Point(double reach) {
    std::uniform_real_distribution<double> coordinate(-reach, reach);
    return {coordinate(random_), coordinate(random_), coordinate(random_)};
  }
  double Number(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random_);
  }

 private:
  std::mt19937 random_{7};
};

TEST(SphereAround, HoldsBothAndTouchesThem) {
  Random random;
  int apart = 0, within = 0;
  for (int i = 0; i < 500; ++i) {
    const Sphere a{random.Point(50), random.Number(1, 100)};
    const Sphere b{random.Point(50), random.Number(1, 30)};
    const double distance = (b.center - a.center).norm();
    const Sphere around = SphereAround(a, b), other_way = SphereAround(b, a);
    const double tolerance = kSphere_rel * (distance + a.radius + b.radius);
    for (const Sphere& inner : {a, b}) {
      EXPECT_LE((inner.center - around.center).norm() + inner.radius, around.radius + tolerance);
    }
    const bool is_within = distance + std::min(a.radius, b.radius) <= std::max(a.radius, b.radius);
    const double least =
        is_within ? std::max(a.radius, b.radius) : (distance + a.radius + b.radius) / 2;
    EXPECT_NEAR(around.radius, least, tolerance);
    EXPECT_NEAR(other_way.radius, least, tolerance);
    EXPECT_LE((other_way.center - around.center).norm(), tolerance);
    (is_within ? within : apart) += 1;
  }
  EXPECT_GT(apart, 20);
  EXPECT_GT(within, 20);
}

TEST(SphereAround, OfConcentricOnesIsTheLarger) {
  const Sphere small{{1, 2, 3}, 4}, large{{1, 2, 3}, 9};
  for (const Sphere& around : {SphereAround(small, large), SphereAround(large, small)}) {
    EXPECT_EQ(around.center, large.center);
    EXPECT_EQ(around.radius, 9);
  }
  EXPECT_EQ(SphereAround(small, small).radius, 4);
}

TEST(Sphere, IsPlacedAsItsPointsAre) {
  const Placement placement = TestPlacement();
  const Sphere sphere{{20, 30, -10}, 25};
  const Sphere placed = placement * sphere;
  EXPECT_NEAR(placed.radius, 0.6 * 25, kSphere_rel * 25);
  Random random;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d on_it = sphere.center + 25 * random.Point(1).normalized();
    EXPECT_NEAR((placement * on_it - placed.center).norm(), placed.radius, 1e-9);
  }
}

TEST(SphereOf, HoldsItsPoints) {
  Random random;
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 40; ++i) points.push_back(Eigen::Vector3d(500, 0, 0) + random.Point(30));
  const Sphere sphere = SphereOf(points);
  double farthest = 0;
  for (const Eigen::Vector3d& point : points) {
    farthest = std::max(farthest, (point - sphere.center).norm());
  }
  EXPECT_LE(farthest, sphere.radius * (1 + kSphere_rel));
  EXPECT_LE(sphere.radius, 30 * std::sqrt(3));
  const std::vector<Eigen::Vector3d> ends = {{0, 0, 0}, {2, 4, 4}};
  EXPECT_EQ(SphereOf(ends).center, Eigen::Vector3d(1, 2, 2));
  EXPECT_NEAR(SphereOf(ends).radius, 3, kSphere_rel);
  EXPECT_EQ(SphereOf({ends.data(), 1}).center, ends[0]);
  EXPECT_GT(SphereOf({ends.data(), 1}).radius, 0);
}

TEST(ViewOf, HoldsTheSphereBetweenItsDepths) {
  const Pose pose = TestPose();
  for (const Sphere& sphere : {Sphere{{3, 5, -2}, 100},
                               {{100, -40, 80}, 1},
                               {{260, -190, 150}, 50},
                               {{500, -400, 300}, 20}}) {
    const GlView view = ViewOf(sphere, TestCamera(), pose);
    const double depth = (pose * sphere.center).z();
    EXPECT_GT(view.near, 0);
    EXPECT_GT(view.far, view.near);
    EXPECT_GE(view.far, depth + sphere.radius);
    if (depth > 2 * sphere.radius) {
      EXPECT_LE(view.near, depth - sphere.radius);
      EXPECT_GT(view.near, depth - 1.5 * sphere.radius) << "precision of depths is lost";
    }
  }
}

TEST(ViewOf, RefusesLensesAndCamerasThatAreNone) {
  Camera lens = TestCamera();
  lens.k1 = 0.1;
  EXPECT_THROW(ViewOf({}, lens, TestPose()), Error);
  Camera flat = TestCamera();
  flat.fx = 0;
  EXPECT_THROW(ViewOf({}, flat, TestPose()), Error);
  Camera odd = TestCamera();
  odd.cy = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(ViewOf({}, odd, TestPose()), Error);
}

TEST(ClipFromModel, PutsPointsAtTheirPixels) {
  const Placement placement = TestPlacement();
  const GlView view = ViewOf({{30, -40, 15}, 60}, TestCamera(), TestPose());
  const Eigen::Vector3d origin(12, -7, 20);
  const Eigen::Matrix4f clip_from_model = ClipFromModel(view, placement, origin);
  Random random;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d in_model = random.Point(50);
    const Eigen::Vector3d in_camera = view.camera_from_world * (placement * in_model);
    const Eigen::Vector2d pixel = Project(view.camera, in_camera).value();
    const Eigen::Vector3f moved = (in_model - origin).cast<float>();
    const Eigen::Vector4f clip = clip_from_model * moved.homogeneous();
    EXPECT_NEAR(clip.x() / clip.w(), 2 * (pixel.x() + 0.5) / 200 - 1, kClip_abs);
    EXPECT_NEAR(clip.y() / clip.w(), 1 - 2 * (pixel.y() + 0.5) / 160, kClip_abs);
    EXPECT_NEAR(clip.w(), in_camera.z(), 1e-6 * in_camera.z());
    // Depths: near is -1, far is 1, and hyperbolic between.
    const double depth =
        (view.far + view.near - 2 * view.far * view.near / in_camera.z()) / (view.far - view.near);
    EXPECT_NEAR(clip.z() / clip.w(), depth, 10 * kClip_abs);
  }
}

TEST(EyeInModel, IsWhereTheCameraStands) {
  const Placement placement = TestPlacement();
  const GlView view = ViewOf({{30, -40, 15}, 60}, TestCamera(), TestPose());
  const Eigen::Vector3d origin(12, -7, 20);
  const Eigen::Vector3d eye = EyeInModel(view, placement, origin).cast<double>();
  EXPECT_LT((placement * (origin + eye) - Eigen::Vector3d(260, -190, 150)).norm(), 1e-4);
}

}  // namespace
}  // namespace lfm
