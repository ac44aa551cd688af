// SPDX-License-Identifier: BSD-3-Clause
#include "calib/pose_estimation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "calib/board.h"
#include "calib/corner_refinement.h"
#include "calib/homography.h"
#include "rendered_board.h"

namespace lfm {
namespace {

Camera PinholeCamera() {
  Camera camera;
  camera.width = 640, camera.height = 480;
  camera.fx = camera.fy = 700;
  camera.cx = 319.5, camera.cy = 239.5;
  return camera;
}

struct Seen {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector2d> plane, pixels;
};

Seen See(const Camera& camera, const Pose& pose, int step = 1) {
  Seen seen;
  const auto corners = BoardCorners(DefaultBoard());
  for (size_t i = 0; i < corners.size(); i += static_cast<size_t>(step)) {
    seen.points.push_back(corners[i]);
    seen.plane.push_back(corners[i].head<2>());
    seen.pixels.push_back(*Project(camera, pose * corners[i]));
  }
  return seen;
}

TEST(FocalFromHomographies, ExactForAPinholeCamera) {
  const Camera camera = PinholeCamera();
  std::vector<Eigen::Matrix3d> homographies;
  for (const Pose& pose : PosesAround(5)) {
    const Seen seen = See(camera, pose);
    homographies.push_back(*FitHomography(seen.plane, seen.pixels));
  }
  const auto focal = FocalFromHomographies(homographies, camera.width, camera.height);
  ASSERT_TRUE(focal);
  EXPECT_NEAR(*focal, 700, 1e-4);
}

TEST(FocalFromHomographies, NoAnswerWithoutSlant) {
  const Camera camera = PinholeCamera();
  const Seen seen = See(camera, LookAt({0, 0, 400}, {0, 0, 0}, {0, 1, 0}));
  EXPECT_FALSE(FocalFromHomographies({*FitHomography(seen.plane, seen.pixels)}, 640, 480));
  EXPECT_FALSE(FocalFromHomographies({}, 640, 480));
  EXPECT_FALSE(FocalFromHomographies({Eigen::Matrix3d::Zero()}, 640, 480));
  EXPECT_FALSE(FocalFromHomographies({Eigen::Matrix3d::Constant(std::nan(""))}, 640, 480));
}

TEST(EstimatePlanarPose, FindsThePoseThroughTheLens) {
  const Camera camera = SmallCamera();
  for (const Pose& pose : PosesAround(9)) {
    const Seen seen = See(camera, pose, 3);
    const auto found = EstimatePlanarPose(camera, seen.points, seen.pixels, 1);
    ASSERT_TRUE(found);
    EXPECT_LT((found->Center() - pose.Center()).norm(), 1e-4);
  }
}

// From far away, the two planar solutions differ by little; noise must not make the wrong one win
// by more than its residual.
TEST(EstimatePlanarPose, KeepsTheBetterOfTheTwoPoses) {
  Camera camera = PinholeCamera();
  camera.fx = camera.fy = 4000;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.1);
  int right = 0;
  for (const Pose& near : PosesAround(12)) {
    const Pose pose = LookAt(7 * near.Center(), {0, 0, 0}, {0, 0, 1});
    Seen seen = See(camera, pose);
    for (Eigen::Vector2d& p : seen.pixels) p += Eigen::Vector2d(noise(random), noise(random));
    const auto found = EstimatePlanarPose(camera, seen.points, seen.pixels, 1);
    ASSERT_TRUE(found);
    right += RotationAngle(found->rotation, pose.rotation) < 0.05;
  }
  EXPECT_EQ(right, 12);
}

TEST(EstimatePlanarPose, NoAnswerForTooLittle) {
  const Camera camera = SmallCamera();
  const Seen seen = See(camera, PosesAround(3)[0]);
  EXPECT_FALSE(EstimatePlanarPose(camera, {}, {}, 1));
  EXPECT_FALSE(EstimatePlanarPose(camera, {seen.points.begin(), seen.points.begin() + 3},
                                  {seen.pixels.begin(), seen.pixels.begin() + 3}, 1));
  std::vector<Eigen::Vector3d> line;
  std::vector<Eigen::Vector2d> pixels;
  for (int i = 0; i < 6; ++i) {
    line.emplace_back(10.0 * i, 5.0 * i, 0);
    pixels.push_back(*Project(camera, PosesAround(3)[0] * line.back()));
  }
  EXPECT_FALSE(EstimatePlanarPose(camera, line, pixels, 1));
}

}  // namespace
}  // namespace lfm
