// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/photo_conditions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sample_data/camera_path.h"

namespace lfm {
namespace {

using V2 = Eigen::Vector2d;
using V3 = Eigen::Vector3d;

std::vector<PhotoSplit> Splits(int count) {
  std::vector<PhotoSplit> splits(count, PhotoSplit::kTrain);
  for (int i = 0; i < count; i += 10) splits[i] = PhotoSplit::kTest;
  return splits;
}

TEST(PhotoConditions, NothingHappensByDefault) {
  for (const PhotoConditions& c : DrawPhotoConditions({}, Splits(40), 7)) {
    EXPECT_EQ(c.exposure_stops, 0);
    EXPECT_EQ(c.gains, Eigen::Vector3f(1, 1, 1));
    EXPECT_EQ(c.travel_mm, V3(0, 0, 0));
    EXPECT_FALSE(c.occluded || c.half_framed);
  }
}

TEST(PhotoConditions, JitterHasTheStatedSpread) {
  PhotoTrouble trouble;
  trouble.exposure_jitter_stops = 0.5;
  trouble.white_balance_jitter_percent = 4;
  trouble.motion_blur_mm = 2;
  constexpr int kCount = 20000;
  double stops = 0, stops2 = 0, red2 = 0, blue2 = 0, product = 0;
  V3 travel(0, 0, 0);
  for (const PhotoConditions& c : DrawPhotoConditions(trouble, Splits(kCount), 3)) {
    stops += c.exposure_stops / kCount;
    stops2 += c.exposure_stops * c.exposure_stops / kCount;
    red2 += std::pow(c.gains.x() - 1, 2) / kCount;
    blue2 += std::pow(c.gains.z() - 1, 2) / kCount;
    product += (c.gains.x() - 1) * (c.gains.z() - 1) / kCount;
    EXPECT_EQ(c.gains.y(), 1);
    EXPECT_NEAR(c.travel_mm.norm(), 2, 1e-12);
    EXPECT_EQ(c.travel_mm.z(), 0);
    travel += c.travel_mm / kCount;
  }
  EXPECT_NEAR(stops, 0, 5 * 0.5 / std::sqrt(kCount));
  EXPECT_NEAR(std::sqrt(stops2), 0.5, 0.015);
  EXPECT_NEAR(std::sqrt(red2), 0.04, 0.0015);
  EXPECT_NEAR(std::sqrt(blue2), 0.04, 0.0015);
  EXPECT_NEAR(product, 0, 1e-4);
  EXPECT_LT(travel.norm(), 0.06);
}

TEST(PhotoConditions, SharesAreExactAndSpareTestPhotographs) {
  PhotoTrouble trouble;
  trouble.occluded_share = 0.25;
  trouble.half_frame_share = 1;
  const std::vector<PhotoSplit> splits = Splits(120);  // 108 for training
  const auto first = DrawPhotoConditions(trouble, splits, 1);
  const auto other = DrawPhotoConditions(trouble, splits, 2);
  int occluded = 0, half = 0, different = 0;
  for (size_t i = 0; i < first.size(); ++i) {
    occluded += first[i].occluded;
    half += first[i].half_framed;
    different += first[i].occluded != other[i].occluded;
    if (splits[i] == PhotoSplit::kTest) {
      EXPECT_FALSE(first[i].occluded || first[i].half_framed);
    }
  }
  EXPECT_EQ(occluded, 27);
  EXPECT_EQ(half, 108);
  EXPECT_GT(different, 10);
}

TEST(Vignetting, FollowsItsLaw) {
  const Camera camera = MakePhotoCamera(400, 300);
  EXPECT_EQ(VignettingGain(camera, 1.5, 199.5, 149.5), 1);
  // The corner of the picture (not the centre of its last pixel) loses what is stated.
  EXPECT_NEAR(VignettingGain(camera, 1.5, 399.5, 299.5), std::exp2(-1.5), 1e-12);
  // cos^4 of the field angle: a lens whose corner is at tan^2 = 2^(stops / 2) - 1.
  const double tan_corner = std::sqrt(std::exp2(1.5 / 2) - 1);
  for (double share : {0.2, 0.5, 0.8}) {
    EXPECT_NEAR(VignettingGain(camera, 1.5, 199.5 + 200 * share, 149.5 + 150 * share),
                std::pow(std::cos(std::atan(share * tan_corner)), 4), 1e-12);
  }
  EXPECT_EQ(VignettingGain(camera, 0, 3, 5), 1);
}

TEST(AimAtBorder, PutsThePointOnTheBorderAndKeepsTheEye) {
  const Camera camera = MakePhotoCamera(400, 300);
  const Pose pose = LookAt(V3(200, -120, 180), V3(3, 2, 40), V3(0, 0, 1));
  const V3 center(0, 0, 45);
  const V2 expected[4] = {{-0.5, 89.5}, {119.5, -0.5}, {399.5, 89.5}, {119.5, 299.5}};
  for (int side = 0; side < 4; ++side) {
    const Pose aimed = AimAtBorder(camera, pose, center, side, 0.3);
    EXPECT_LT((aimed.Center() - pose.Center()).norm(), 1e-9);
    EXPECT_LT((*Project(camera, aimed * center) - expected[side]).norm(), 1e-6);
  }
}

TEST(ExposureSamples, AreTheOnePictureWithoutBlur) {
  const Pose pose = LookAt(V3(200, -120, 180), V3(3, 2, 40), V3(0, 0, 1));
  const auto samples = ExposureSamples(pose, V3(0, 0, 0), 0, 300, 16);
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_EQ(samples[0].camera_from_world.translation, pose.translation);
  EXPECT_EQ(samples[0].shift_x, 0);
}

// Where a point appears in each of an exposure's pictures, by inverting the shifted rays.
std::vector<V2> Seen(const Camera& camera, const std::vector<ExposureSample>& samples,
                     const V3& point) {
  std::vector<V2> seen;
  for (const ExposureSample& s : samples) {
    const V3 p = s.camera_from_world * point;
    seen.push_back(*Project(camera, V3(p.x() / p.z() - s.shift_x, p.y() / p.z() - s.shift_y, 1)));
  }
  return seen;
}

V2 Mean(const std::vector<V2>& points) {
  V2 mean(0, 0);
  for (const V2& p : points) mean += p / static_cast<double>(points.size());
  return mean;
}

TEST(ExposureSamples, DefocusIsTheThinLensCircleOfConfusion) {
  Camera camera = MakePhotoCamera(960, 720);
  camera.k1 = camera.k2 = camera.k3 = camera.p1 = camera.p2 = 0;
  camera.fy = camera.fx;
  const Pose pose = LookAt(V3(0, -300, 0), V3(0, 0, 0), V3(0, 0, 1));
  constexpr double kAperture = 8, kFocus = 300;
  const auto samples = ExposureSamples(pose, V3(0, 0, 0), kAperture, kFocus, 64);
  ASSERT_EQ(samples.size(), 64u);
  for (const V3& in_focus : {V3(0, 0, 0), V3(40, 0, 25), V3(-30, 0, -60)}) {
    for (const V2& p : Seen(camera, samples, in_focus)) {
      EXPECT_LT((p - *Project(camera, pose * in_focus)).norm(), 1e-3);
    }
  }
  for (double depth : {200.0, 260.0, 420.0}) {
    const V3 point(12, depth - 300, 7);
    const double radius = 0.5 * kAperture * camera.fx * std::abs(1 / kFocus - 1 / depth);
    const auto seen = Seen(camera, samples, point);
    const V2 center = *Project(camera, pose * point);
    EXPECT_LT((Mean(seen) - center).norm(), 0.01);
    double furthest = 0, squares = 0;
    for (const V2& p : seen) {
      furthest = std::max(furthest, (p - center).norm());
      squares += (p - center).squaredNorm() / 64;
    }
    EXPECT_LE(furthest, radius * 1.03);
    EXPECT_GT(furthest, radius * 0.9);
    // A full disc has half its radius squared on average.
    EXPECT_NEAR(squares / (radius * radius), 0.5, 0.02);
  }
}

TEST(ExposureSamples, MotionIsEvenAndItsMiddleIsThePose) {
  Camera camera = MakePhotoCamera(960, 720);
  camera.k1 = camera.k2 = camera.k3 = camera.p1 = camera.p2 = 0;
  const Pose pose = LookAt(V3(0, -300, 0), V3(0, 0, 0), V3(0, 0, 1));
  const auto samples = ExposureSamples(pose, V3(1.5, 0, 0), 0, 300, 12);
  ASSERT_EQ(samples.size(), 12u);
  const V3 point(20, 15, 30);
  std::vector<V2> seen = Seen(camera, samples, point);
  EXPECT_LT((Mean(seen) - *Project(camera, pose * point)).norm(), 1e-9);
  std::sort(seen.begin(), seen.end(), [](const V2& a, const V2& b) { return a.x() < b.x(); });
  const double step = 1.5 * camera.fx / 315 / 12;
  for (size_t i = 1; i < seen.size(); ++i) {
    EXPECT_NEAR(seen[i].x() - seen[i - 1].x(), step, 1e-9);
    EXPECT_NEAR(seen[i].y(), seen[0].y(), 1e-9);
  }
}

TEST(PixelRays, ShiftedRaysGoThroughTheSamePlaneOfFocus) {
  const Camera camera = MakePhotoCamera(64, 48);
  const PixelRays rays(camera);
  constexpr float kFocus = 250, kA = 3, kB = -2;
  const PixelRays shifted = rays.Shifted(-kA / kFocus, -kB / kFocus);
  for (int y : {0, 20, 47}) {
    for (int x : {0, 31, 63}) {
      const Eigen::Vector3f middle = kFocus * rays.Direction(x, y, 0.25f, -0.4f);
      const Eigen::Vector3f off =
          Eigen::Vector3f(kA, kB, 0) + kFocus * shifted.Direction(x, y, 0.25f, -0.4f);
      EXPECT_LT((middle - off).norm(), 1e-4f);
    }
  }
}

}  // namespace
}  // namespace lfm
