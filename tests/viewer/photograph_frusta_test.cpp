// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/photograph_frusta.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lfm {
namespace {

constexpr double kDepth = 50;

PosedCamera LensCamera() {
  PosedCamera posed;
  posed.camera.width = 120;
  posed.camera.height = 90;
  posed.camera.fx = 150;
  posed.camera.fy = 142;
  posed.camera.cx = 57.3;
  posed.camera.cy = 47.8;
  posed.camera.k1 = -0.21;
  posed.camera.p1 = 0.004;
  posed.camera_from_world = LookAt({120, -80, 210}, {4, 5, 6}, {0.1, 0, 1});
  return posed;
}

/// Ends of the lines that begin at the eye, in the camera frame; the eye stands at no other place.
std::vector<Eigen::Vector3d> Spokes(const PosedCamera& posed,
                                    const std::vector<Eigen::Vector3d>& lines) {
  std::vector<Eigen::Vector3d> ends;
  for (size_t i = 0; i + 1 < lines.size(); i += 2) {
    const Eigen::Vector3d a = posed.camera_from_world * lines[i];
    const Eigen::Vector3d b = posed.camera_from_world * lines[i + 1];
    if (a.norm() < 1e-9 * kDepth) ends.push_back(b);
    EXPECT_NEAR(b.z(), kDepth, 1e-9 * kDepth);
    EXPECT_TRUE(a.norm() < 1e-9 * kDepth || std::abs(a.z() - kDepth) < 1e-9 * kDepth);
  }
  return ends;
}

TEST(FrustumLines, LeadToTheCornersOfThePicture) {
  const PosedCamera posed = LensCamera();
  const std::vector<Eigen::Vector3d> lines = FrustumLines(posed, kDepth);
  ASSERT_EQ(lines.size() % 2, 0u);
  const std::vector<Eigen::Vector3d> spokes = Spokes(posed, lines);
  ASSERT_EQ(spokes.size(), 4u);
  for (const Eigen::Vector2d& corner :
       {Eigen::Vector2d(-0.5, -0.5), {119.5, -0.5}, {119.5, 89.5}, {-0.5, 89.5}}) {
    constexpr double kPixel_abs = 1e-6;
    EXPECT_EQ(std::count_if(spokes.begin(), spokes.end(),
                            [&](const Eigen::Vector3d& end) {
                              return (*Project(posed.camera, end) - corner).norm() < kPixel_abs;
                            }),
              1)
        << corner.transpose();
    // One spoke and two sides of the frame.
    EXPECT_EQ(std::count_if(lines.begin(), lines.end(),
                            [&](const Eigen::Vector3d& point) {
                              const auto pixel =
                                  Project(posed.camera, posed.camera_from_world * point);
                              return pixel && (*pixel - corner).norm() < kPixel_abs;
                            }),
              3)
        << corner.transpose();
  }
}

TEST(FrustumLines, MarkTheUpperEdge) {
  PosedCamera posed = LensCamera();
  posed.camera.k1 = posed.camera.p1 = 0;
  double highest = 0, lowest = 0;
  for (const Eigen::Vector3d& point : FrustumLines(posed, kDepth)) {
    const Eigen::Vector3d in_camera = posed.camera_from_world * point;
    if (in_camera.z() < 1) continue;  // the eye
    const auto pixel = Project(posed.camera, in_camera);
    highest = std::min(highest, pixel->y());
    lowest = std::max(lowest, pixel->y());
    // The mark stands over the middle.
    if (pixel->y() < -1) {
      EXPECT_NEAR(pixel->x(), 59.5, 1e-6);
    }
  }
  EXPECT_NEAR(lowest, 89.5, 1e-6);
  EXPECT_LT(highest, -5);
  EXPECT_GT(highest, -45);
}

TEST(FrustumLines, StandWhereAPinholeHasThemIfTheLensFoldsBack) {
  PosedCamera posed = LensCamera();
  posed.camera.k1 = -1.8;
  posed.camera.p1 = 0;
  const std::vector<Eigen::Vector3d> folded = FrustumLines(posed, kDepth);
  posed.camera.k1 = 0;
  const std::vector<Eigen::Vector3d> straight = FrustumLines(posed, kDepth);
  ASSERT_EQ(folded.size(), straight.size());
  for (size_t i = 0; i < folded.size(); ++i) EXPECT_LT((folded[i] - straight[i]).norm(), 1e-9);
}

/// The view: at the origin, along z.
Camera View() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 400;
  camera.cx = 319.5;
  camera.cy = 239.5;
  return camera;
}

/// Looks along z too; its picture reaches 25 mm to each side at 50 mm.
PosedPhotograph PhotographAt(const Eigen::Vector3d& eye) {
  PosedPhotograph photograph;
  Camera& camera = photograph.camera.camera;
  camera.width = camera.height = 200;
  camera.fx = camera.fy = 200;
  camera.cx = camera.cy = 99.5;
  photograph.camera.camera_from_world.translation = -eye;
  return photograph;
}

int Pick(const std::vector<PosedPhotograph>& photographs, const Eigen::Vector2d& at, double reach) {
  return PickFrustum(photographs, kDepth, View(), {}, at, reach);
}

/// Where the view has a point, by the pinhole's formula alone: one behind the eye is mirrored.
Eigen::Vector2d PixelOf(const Eigen::Vector3d& point) {
  return {400 * point.x() / point.z() + 319.5, 400 * point.y() / point.z() + 239.5};
}

TEST(PickFrustum, ReachesSoManyPixelsFromALine) {
  const std::vector<PosedPhotograph> photographs = {PhotographAt({0, 0, 100})};
  // The left side of its frame, at z = 150.
  const Eigen::Vector2d left = PixelOf({-25, 3, 150});
  EXPECT_EQ(Pick(photographs, left, 0.001), 0);
  EXPECT_EQ(Pick(photographs, left - Eigen::Vector2d(3, 0), 3.001), 0);
  EXPECT_EQ(Pick(photographs, left - Eigen::Vector2d(3, 0), 2.999), -1);
  // Beyond a corner the distance is the corner's.
  const Eigen::Vector2d corner = PixelOf({25, 25, 150}) + Eigen::Vector2d(3, 4);
  EXPECT_EQ(Pick(photographs, corner, 5.001), 0);
  EXPECT_EQ(Pick(photographs, corner, 4.999), -1);
  // A spoke, between its ends.
  EXPECT_EQ(Pick(photographs, PixelOf({-10, 10, 120}), 0.001), 0);
  // The frame is not filled.
  EXPECT_EQ(Pick(photographs, PixelOf({-10, 3, 150}), 2), -1);
}

TEST(PickFrustum, TakesTheNearestOnThePicture) {
  // Their left sides: 66.7 and 71.7 pixels left of the middle.
  const std::vector<PosedPhotograph> photographs = {PhotographAt({0, 0, 100}),
                                                    PhotographAt({-1.875, 0, 100})};
  const double y = PixelOf({0, 3, 150}).y();
  EXPECT_EQ(Pick(photographs, {319.5 - 68, y}, 10), 0);
  EXPECT_EQ(Pick(photographs, {319.5 - 70, y}, 10), 1);
  // The first of equal ones.
  EXPECT_EQ(Pick({PhotographAt({0, 0, 100}), PhotographAt({0, 0, 100})}, {319.5 - 68, y}, 10), 0);
  // How far they are from the eye does not matter.
  EXPECT_EQ(
      Pick({PhotographAt({300, 0, 100}), PhotographAt({0, 0, 5000})}, PixelOf({0, 0, 5000}), 10),
      1);
}

TEST(PickFrustum, DoesNotPickBehindTheEye) {
  // Wholly behind: its mirror image would be hit.
  EXPECT_EQ(Pick({PhotographAt({30, 0, -100})}, PixelOf({30, 0, -100}), 10), -1);
  // Its eye is behind, its frame before: a spoke leaves the picture on its own side.
  const Eigen::Vector3d eye(30, 0, -20), corner(5, -25, 30);
  const std::vector<PosedPhotograph> photographs = {PhotographAt(eye)};
  const auto on_spoke = [&](double share) -> Eigen::Vector3d {
    return eye + share * (corner - eye);
  };
  EXPECT_EQ(Pick(photographs, PixelOf(corner), 0.001), 0);
  EXPECT_EQ(Pick(photographs, PixelOf(on_spoke(0.7)), 0.001), 0);
  EXPECT_EQ(Pick(photographs, PixelOf(on_spoke(0.42)), 0.001), 0);
  EXPECT_EQ(Pick(photographs, PixelOf(eye), 10), -1);
  EXPECT_EQ(Pick(photographs, PixelOf(on_spoke(0.2)), 10), -1);
  // Halfway to where the eye would be mirrored to.
  EXPECT_EQ(Pick(photographs, 0.5 * (PixelOf(corner) + PixelOf(eye)), 10), -1);
}

TEST(PickFrustum, FollowsTheViewsPose) {
  const Pose camera_from_world = LookAt({10, 300, 40}, {0, 0, 60}, {0, 0, 1});
  const PosedPhotograph photograph = PhotographAt({12, -7, 20});
  const Eigen::Vector2d at = PixelOf(camera_from_world * Eigen::Vector3d(12 + 25, -7 + 4, 70));
  EXPECT_EQ(PickFrustum({photograph}, kDepth, View(), camera_from_world, at, 0.01), 0);
  EXPECT_EQ(PickFrustum({photograph}, kDepth, View(), {}, at, 0.01), -1);
}

TEST(PickFrustum, PicksNothingWhereNothingIs) {
  EXPECT_EQ(Pick({}, {319.5, 239.5}, 1e9), -1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Pick({PhotographAt({0, 0, 100})}, {nan, 100}, 1e9), -1);
  EXPECT_EQ(Pick({PhotographAt({0, 0, 100})}, {100, 100}, 1e9), 0);
}

}  // namespace
}  // namespace lfm
