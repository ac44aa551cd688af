// SPDX-License-Identifier: BSD-3-Clause
#include "scan/triangulate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "tests/scan/synthetic_rig.h"

namespace lfm {
namespace {

using testing::HitPlate;
using testing::HitSphere;
using testing::KnownRig;
using testing::Surface;
using testing::SurfaceHit;
using testing::TurnedPlatform;

/// Columns in closed form: no pictures, no noise.
DecodedPixels ExactColumns(const RigCalibration& rig, const Pose& pose, const Surface& surface) {
  DecodedPixels decoded;
  decoded.width = rig.camera.width;
  decoded.height = rig.camera.height;
  const size_t pixels = static_cast<size_t>(decoded.width) * decoded.height;
  decoded.white.assign(pixels, 0.5F);
  decoded.contrast.assign(pixels, 0.5F);
  decoded.column.position.assign(pixels, 0);
  decoded.column.sigma.assign(pixels, 0);
  decoded.column.confidence.assign(pixels, 0);
  const Pose world_from_camera = pose.Inverse();
  for (size_t p = 0; p < pixels; ++p) {
    const Eigen::Vector2d pixel(static_cast<double>(p % decoded.width),
                                static_cast<double>(p / decoded.width));
    const Eigen::Vector3d direction = world_from_camera.rotation * Unproject(rig.camera, pixel);
    const auto hit = surface(pose.Center(), direction);
    if (!hit) continue;
    const Eigen::Vector3d point = pose * (pose.Center() + hit->distance * direction);
    const auto source = Project(rig.projector, rig.projector_from_camera * point);
    if (!source || !rig.projector.Contains(*source)) continue;
    decoded.column.position[p] = static_cast<float>(source->x());
    decoded.column.sigma[p] = 0.02F;
    decoded.column.confidence[p] = 1;
  }
  return decoded;
}

std::optional<SurfaceHit> Ball(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  return HitSphere(origin, direction, {0, 0, 50}, 40);
}

TEST(Triangulate, DepthInvertsTheProjectionOfADistortedRig) {
  for (bool distorted : {false, true}) {
    const RigCalibration rig = KnownRig(distorted);
    int tested = 0;
    for (double z = 0; z <= 120; z += 20) {
      for (double x = -80; x <= 80; x += 20) {
        const Eigen::Vector3d point = TurnedPlatform(0) * Eigen::Vector3d(x, 0.7 * x, z);
        const auto source = Project(rig.projector, rig.projector_from_camera * point);
        if (!source || !rig.projector.Contains(*source)) continue;
        const auto depth = DepthFromColumn(rig, point.hnormalized(), source->x());
        ASSERT_TRUE(depth);
        EXPECT_NEAR(*depth, point.z(), 1e-6);
        ++tested;
      }
    }
    EXPECT_GT(tested, 30);
  }
}

TEST(Triangulate, NoDepthWhereRaysDoNotMeetInFront) {
  const RigCalibration rig = KnownRig(false);
  const Eigen::Vector2d ray(0, 0);
  const Eigen::Vector3d far_away(0, 0, 1e9);
  const double vanishing = Project(rig.projector, rig.projector_from_camera * far_away)->x();
  int answers = 0;
  for (double column = -1000; column < 2000; column += 0.5) {
    const auto depth = DepthFromColumn(rig, ray, column);
    if (!depth) continue;
    ++answers;
    EXPECT_GT(*depth, 0);
    EXPECT_GE(column, -0.5);
    EXPECT_LT(column, 511.5);
  }
  EXPECT_GT(answers, 100);
  EXPECT_FALSE(DepthFromColumn(rig, ray, vanishing - 1) &&
               DepthFromColumn(rig, ray, vanishing + 1));
  EXPECT_FALSE(DepthFromColumn(rig, ray, std::nan("")));
}

TEST(Triangulate, BallComesBackWithNormalsTowardsTheScanner) {
  const RigCalibration rig = KnownRig(true);
  const Pose pose = TurnedPlatform(30);
  const std::vector<Eigen::Vector2d> rays = NormalizedRays(rig.camera);
  const RangeMap map = Triangulate(rig, rays, ExactColumns(rig, pose, Ball), {});
  const Eigen::Vector3d center = pose * Eigen::Vector3d(0, 0, 50);
  int count = 0;
  for (size_t p = 0; p < rays.size(); ++p) {
    if (map.depth[p] <= 0) {
      EXPECT_EQ(map.confidence[p], 0);
      continue;
    }
    ++count;
    const Eigen::Vector3d point = map.depth[p] * rays[p].homogeneous();
    EXPECT_NEAR((point - center).norm(), 40, 0.01);
    const Eigen::Vector3d normal = map.normal[p].cast<double>();
    EXPECT_NEAR(normal.norm(), 1, 1e-5);
    EXPECT_LT(normal.dot(point), 0);
    EXPECT_GT(normal.dot((point - center).normalized()), 0.99);
    EXPECT_LE(map.confidence[p], 1);
    EXPECT_GE(map.confidence[p], ScanOptions().min_confidence);
  }
  EXPECT_GT(count, 1000);
}

TEST(Triangulate, NothingFloatsBetweenBallAndPlate) {
  const RigCalibration rig = KnownRig(false);
  const Pose pose = TurnedPlatform(0);
  const Surface scene = [](const Eigen::Vector3d& o, const Eigen::Vector3d& d) {
    const auto ball = Ball(o, d);
    return ball ? ball : HitPlate(o, d);
  };
  DecodedPixels decoded = ExactColumns(rig, pose, scene);
  // Mixed pixels: at each step between ball and plate, a column half way between the two.
  int mixed = 0;
  std::vector<float> position = decoded.column.position;
  for (size_t p = 1; p + 1 < position.size(); ++p) {
    const double step = position[p + 1] - position[p - 1];
    if (std::abs(step) < 30 || std::abs(step) > 200) continue;
    decoded.column.position[p] = (position[p + 1] + position[p - 1]) / 2;
    ++mixed;
  }
  ASSERT_GT(mixed, 40);
  const std::vector<Eigen::Vector2d> rays = NormalizedRays(rig.camera);
  const RangeMap map = Triangulate(rig, rays, decoded, {});
  int kept = 0;
  for (size_t p = 0; p < rays.size(); ++p) {
    if (map.depth[p] <= 0) continue;
    ++kept;
    const Eigen::Vector3d point = pose.Inverse() * (map.depth[p] * rays[p].homogeneous());
    const double off =
        std::min(std::abs((point - Eigen::Vector3d(0, 0, 50)).norm() - 40), std::abs(point.z()));
    EXPECT_LT(off, 0.6) << point.transpose();
  }
  EXPECT_GT(kept, 8000);
}

TEST(Triangulate, AWallThatBothEyesGrazeIsMeasured) {
  const RigCalibration rig = KnownRig(false);
  const Pose pose = TurnedPlatform(0);
  const Eigen::Vector3d middle(0, 0, 40);
  const Eigen::Vector3d to_camera = (pose.Center() - middle).normalized();
  const Eigen::Vector3d baseline =
      pose.Inverse().rotation * rig.projector_from_camera.Center().normalized();
  // Turned away about the baseline, so that camera and projector see it at like angles.
  const double angle = 83 * M_PI / 180;
  const Eigen::Vector3d normal =
      std::cos(angle) * to_camera + std::sin(angle) * to_camera.cross(baseline).normalized();
  const Surface wall = [&](const Eigen::Vector3d& o,
                           const Eigen::Vector3d& d) -> std::optional<SurfaceHit> {
    SurfaceHit hit;
    hit.distance = normal.dot(middle - o) / normal.dot(d);
    if ((o + hit.distance * d - middle).norm() > 60) return std::nullopt;
    return hit;
  };
  const DecodedPixels decoded = ExactColumns(rig, pose, wall);
  const std::vector<Eigen::Vector2d> rays = NormalizedRays(rig.camera);
  const RangeMap map = Triangulate(rig, rays, decoded, {});
  int seen = 0, measured = 0;
  for (size_t p = 0; p < rays.size(); ++p) {
    if (decoded.column.confidence[p] <= 0) continue;
    ++seen;
    if (map.depth[p] <= 0) continue;
    ++measured;
    const Eigen::Vector3d point = pose.Inverse() * (map.depth[p] * rays[p].homogeneous());
    EXPECT_NEAR(normal.dot(point - middle), 0, 0.01);
    EXPECT_GT(map.sigma_mm[p], 0);
  }
  EXPECT_GT(seen, 300);
  EXPECT_GT(measured, 0.7 * seen);
}

TEST(Triangulate, GrazingViewsAreDropped) {
  const RigCalibration rig = KnownRig(false);
  const Pose pose = TurnedPlatform(0);
  const std::vector<Eigen::Vector2d> rays = NormalizedRays(rig.camera);
  ScanOptions options;
  options.max_grazing_deg = 45;
  const RangeMap map = Triangulate(rig, rays, ExactColumns(rig, pose, Ball), options);
  const Eigen::Vector3d center = pose * Eigen::Vector3d(0, 0, 50);
  int count = 0;
  for (size_t p = 0; p < rays.size(); ++p) {
    if (map.depth[p] <= 0) continue;
    ++count;
    const Eigen::Vector3d point = map.depth[p] * rays[p].homogeneous();
    EXPECT_GT((point - center).normalized().dot(-point.normalized()), std::cos(47 * M_PI / 180));
  }
  EXPECT_GT(count, 300);
}

TEST(Triangulate, PixelsWhereTheLensFoldsMeasureNothing) {
  RigCalibration rig = KnownRig(false);
  const Pose pose = TurnedPlatform(0);
  DecodedPixels decoded = ExactColumns(rig, pose, HitPlate);
  rig.camera.k1 = -2.4;
  const std::vector<Eigen::Vector2d> rays = NormalizedRays(rig.camera);
  // What a scan of the plate decodes to through this lens; in the corners, anything.
  int folded = 0;
  for (size_t p = 0; p < rays.size(); ++p) {
    decoded.column.position[p] = 100;
    decoded.column.sigma[p] = 0.02F;
    decoded.column.confidence[p] = 1;
    folded += rays[p].allFinite() ? 0 : 1;
    if (!rays[p].allFinite()) continue;
    const Eigen::Vector3d direction = pose.Inverse().rotation * rays[p].homogeneous().normalized();
    const auto hit = HitPlate(pose.Center(), direction);
    if (!hit) continue;
    const Eigen::Vector3d point = pose * (pose.Center() + hit->distance * direction);
    const auto source = Project(rig.projector, rig.projector_from_camera * point);
    if (source) decoded.column.position[p] = static_cast<float>(source->x());
  }
  ASSERT_GT(folded, 100);
  const RangeMap map = Triangulate(rig, rays, decoded, {});
  int measured = 0;
  for (size_t p = 0; p < rays.size(); ++p) {
    if (!rays[p].allFinite()) {
      EXPECT_EQ(map.depth[p], 0);
    } else if (map.depth[p] > 0) {
      EXPECT_NEAR((pose.Inverse() * (map.depth[p] * rays[p].homogeneous())).z(), 0, 0.05);
      ++measured;
    }
  }
  EXPECT_GT(measured, 3000);
}

TEST(Triangulate, LonePixelsAndEmptyScansLeaveNothing) {
  const RigCalibration rig = KnownRig(false);
  const std::vector<Eigen::Vector2d> rays = NormalizedRays(rig.camera);
  DecodedPixels decoded = ExactColumns(rig, TurnedPlatform(0), HitPlate);
  for (size_t p = 0; p < rays.size(); ++p) {
    const bool lone = p % 7 == 0 && (p / decoded.width) % 7 == 0;
    if (!lone) decoded.column.confidence[p] = 0;
  }
  const RangeMap map = Triangulate(rig, rays, decoded, {});
  for (double depth : map.depth) EXPECT_EQ(depth, 0);
  decoded.width = 239;
  EXPECT_THROW(Triangulate(rig, rays, decoded, {}), Error);
}

}  // namespace
}  // namespace lfm
