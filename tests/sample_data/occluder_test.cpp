// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/occluder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sample_data/camera_path.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

double DistanceToSegment(const V3& p, const V3& a, const V3& b) {
  const V3 axis = b - a;
  const double t = axis.isZero() ? 0 : std::clamp((p - a).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
  return (p - a - t * axis).norm();
}

// Against marching along the ray with the distance to the surface as the step.
TEST(Capsule, IntersectionIsWhereTheDistanceFirstVanishes) {
  RandomStream random(4, 5, 6);
  const auto place = [&](double size) {
    return V3(random.Uniform(-size, size), random.Uniform(-size, size),
              random.Uniform(-size, size));
  };
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    Capsule capsule{place(10), place(10), random.Uniform(0.5, 4)};
    if (i % 10 == 0) capsule.b = capsule.a;  // a ball
    const V3 origin = 40 * place(1).normalized();
    const V3 direction = 0.3 * (place(8) - origin);
    const auto hit = IntersectCapsule(capsule, origin, direction);
    double t = 0;
    bool met = false;
    for (int step = 0; step < 400 && t < 10; ++step) {
      const double gap =
          DistanceToSegment(origin + t * direction, capsule.a, capsule.b) - capsule.radius;
      met = gap < 1e-9;
      if (met) break;
      t += gap / direction.norm();
    }
    if (!hit) {
      EXPECT_FALSE(met && t < 10);
      continue;
    }
    ++hits;
    const V3 point = origin + hit->distance * direction;
    EXPECT_NEAR(DistanceToSegment(point, capsule.a, capsule.b), capsule.radius, 1e-9);
    EXPECT_NEAR(hit->normal.norm(), 1, 1e-9);
    EXPECT_LE(hit->normal.dot(direction), 1e-9);
    // Grazing rays march slowly and stop short.
    if (met && hit->normal.dot(direction.normalized()) < -0.2) {
      EXPECT_NEAR(hit->distance, t, 1e-6);
    }
  }
  EXPECT_GT(hits, 300);
}

TEST(Capsule, BehindTheEyeIsNotSeen) {
  EXPECT_FALSE(IntersectCapsule({V3(0, 0, -9), V3(1, 0, -9), 2}, V3(0, 0, 0), V3(0, 0, 1)));
  EXPECT_FALSE(IntersectCapsule({V3(5, -9, 9), V3(5, 9, 9), 2}, V3(0, 0, 0), V3(0, 0, 1)));
  const auto along = IntersectCapsule({V3(0, 0, 5), V3(0, 0, 9), 2}, V3(0, 0, 0), V3(0, 0, 2));
  ASSERT_TRUE(along);
  EXPECT_NEAR(along->distance, 1.5, 1e-12);
}

RenderedPhoto WhitePhoto(const Camera& camera) {
  RenderedPhoto photo;
  photo.radiance =
      Image(camera.width, camera.height, 3, PixelType::kFloat32, ColorEncoding::kLinear);
  for (size_t i = 0; i < photo.radiance.size(); ++i) photo.radiance.Data<float>()[i] = 50;
  photo.mask = Image(camera.width, camera.height, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  for (size_t i = 0; i < photo.mask.size(); ++i) photo.mask.Data<uint8_t>()[i] = 255;
  return photo;
}

// A ball in even surroundings: its picture's area and colour in closed form.
TEST(Occluder, BallHasItsAreaAndTheAlbedoOfItsSurroundings) {
  Camera camera = MakePhotoCamera(200, 150);
  camera.k1 = camera.k2 = camera.k3 = camera.p1 = camera.p2 = 0;
  const Pose pose = LookAt(V3(0, -300, 30), V3(0, 0, 30), V3(0, 0, 1));
  Occluder ball;
  ball.albedo = {0.2f, 0.4f, 0.8f};
  // On the axis of view: seen as a circle.
  const V3 center = pose.Inverse() * V3(0, 0, 150);
  ball.capsules = {{center, center, 12}};
  Lighting lighting;
  lighting.sky = lighting.wall = lighting.ground = Eigen::Vector3f(2, 2, 2);
  RenderedPhoto photo = WhitePhoto(camera);
  CoverWithOccluder(ball, lighting, PixelRays(camera), pose, photo);
  double coverage = 0, masked = 0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const float red = photo.radiance.At<float>(x, y);
      coverage += (50 - red) / (50 - 0.3);
      masked += photo.mask.At<uint8_t>(x, y) == 0;
    }
  }
  const double tangent = 12 / std::sqrt(150.0 * 150 - 144);
  const double area = std::numbers::pi * tangent * tangent * camera.fx * camera.fy;
  EXPECT_NEAR(coverage / area, 1, 0.01);
  EXPECT_NEAR(masked / area, 1, 0.03);
  // Its middle faces the camera, and is lit as the room is seen from there.
  const Eigen::Vector3f expected =
      ball.albedo.cwiseProduct(lighting.Environment(Eigen::Vector3f(0, -1, 0)));
  const int cx = static_cast<int>(std::lround(camera.cx)), cy = static_cast<int>(camera.cy);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(photo.radiance.At<float>(cx, cy, c), expected[c], 0.03 * expected[c]);
  }
}

TEST(Occluder, SticksAndHandsReachInFromTheBorderNearerThanTheSubject) {
  const Camera camera = MakePhotoCamera(160, 120);
  const PixelRays rays(camera);
  const Lighting lighting = MakeStudioLighting();
  const V3 center(0, 0, 56);
  const Pose pose = LookAt(V3(150, -160, 170), center, V3(0, 0, 1));
  for (OccluderKind kind : {OccluderKind::kStick, OccluderKind::kHand}) {
    double covered = 0;
    for (uint64_t i = 0; i < 12; ++i) {
      RandomStream random(1, 2, i);
      const Occluder occluder = MakeOccluder(kind, camera, pose, center, random);
      for (const Capsule& c : occluder.capsules) {
        EXPECT_LT((pose * c.a).z(), 0.72 * (pose * center).z());
        EXPECT_LT((pose * c.b).z(), 0.72 * (pose * center).z());
      }
      RenderedPhoto photo = WhitePhoto(camera);
      CoverWithOccluder(occluder, lighting, rays, pose, photo);
      int inside = 0, border = 0;
      for (int y = 0; y < 120; ++y) {
        for (int x = 0; x < 160; ++x) {
          const bool gone = photo.mask.At<uint8_t>(x, y) == 0;
          inside += gone;
          border += gone && (x == 0 || y == 0 || x == 159 || y == 119);
          if (gone) {
            EXPECT_GT(photo.radiance.At<float>(x, y), 0);
            EXPECT_LT(photo.radiance.At<float>(x, y), 49);
          }
        }
      }
      EXPECT_GT(border, 0);
      EXPECT_GT(inside, 50);
      covered += inside / (160.0 * 120 * 12);
    }
    EXPECT_GT(covered, kind == OccluderKind::kStick ? 0.02 : 0.08);
    EXPECT_LT(covered, kind == OccluderKind::kStick ? 0.2 : 0.6);
  }
}

}  // namespace
}  // namespace lfm
