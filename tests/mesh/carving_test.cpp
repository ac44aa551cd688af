// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/carving.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/progress.h"
#include "core/ray_scene.h"
#include "mesh/cleaning.h"
#include "mesh/reconstruction.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

// What an eye sees of a shape: the points whose way to it is clear.
PointCloud SeenFrom(const TriangleMesh& shape, const Eigen::Vector3d& eye, int count,
                    unsigned seed) {
  test::CloudNoise noise;
  noise.along_normal_mm = 0.03;
  noise.hidden_below_normal_z = -2;
  noise.seed = seed;
  const PointCloud all = test::MeasureCloud(shape, count, noise);
  const RayScene scene(shape);
  PointCloud seen;
  for (size_t i = 0; i < all.points.size(); ++i) {
    const Eigen::Vector3d way = eye - all.points[i];
    if (way.normalized().dot(all.normals[i]) < 0.15) continue;
    if (scene.Occluded(all.points[i], way, 2e-3, 1)) continue;
    seen.points.push_back(all.points[i]);
    seen.normals.push_back(all.normals[i]);
    seen.confidence.push_back(1);
  }
  return seen;
}

// A thin column that carries half a ball. From above and level nobody sees the flat underside, and
// what is closed without data goes on downwards as the ball does; but the column was seen past it.
struct Mushroom {
  TriangleMesh shape;
  PointCloud cloud;
  std::vector<ScanSight> sights;

  Mushroom() {
    shape = test::MakeBox({-6, -6, 0}, {6, 6, 41}, 4);
    TriangleMesh cap = test::MakeSphere(25, 4, {0, 0, 40});
    for (Eigen::Vector3d& v : cap.vertices) v.z() = std::max(v.z(), 40.0);
    const int base = static_cast<int>(shape.vertices.size());
    shape.vertices.insert(shape.vertices.end(), cap.vertices.begin(), cap.vertices.end());
    for (const Eigen::Vector3i& t : cap.triangles) {
      shape.triangles.push_back(t + Eigen::Vector3i::Constant(base));
    }
    for (int k = 0; k < 24; ++k) {
      const double turn = 2 * M_PI * k / 24;
      const Eigen::Vector3d eye(400 * std::cos(turn), 400 * std::sin(turn), k % 4 == 0 ? 250 : 42);
      const auto first = static_cast<int64_t>(cloud.points.size());
      test::Append(cloud, SeenFrom(shape, eye, 8000, k + 1));
      sights.push_back({{eye}, first, static_cast<int64_t>(cloud.points.size())});
    }
  }

  ReconstructedSurface Reconstruct(bool with_sights) const {
    const CleanCloud clean = CleanPoints(cloud, {});
    const FreeSpace free(cloud, with_sights ? sights : std::vector<ScanSight>{},
                         4 * clean.spacing_mm);
    return ReconstructSurface(clean.cloud, clean.spacing_mm, {SurfaceMethod::kPoisson, 7}, free,
                              SilentProgress());
  }
};

// Share of the air about the column, below the cap, that the mesh fills.
double AirFilled(const TriangleMesh& mesh) {
  const RayScene scene(mesh);
  int inside = 0, all = 0;
  for (int x = -24; x <= 24; x += 2) {
    for (int y = -24; y <= 24; y += 2) {
      for (int z = 20; z <= 38; z += 3) {
        if (std::hypot(x, y) < 10 || std::hypot(x, y) > 24) continue;
        int crossings = 0;
        double from = 0;
        const Eigen::Vector3d p(x + 0.1, y + 0.2, z);
        while (const auto hit = scene.Intersect(p, Eigen::Vector3d(0.1, 0.2, 1), from)) {
          ++crossings;
          from = hit->distance + 1e-4;
        }
        inside += crossings % 2;
        ++all;
      }
    }
  }
  return static_cast<double>(inside) / all;
}

TEST(Carving, WhatWasSeenThroughIsNotClosedOver) {
  const Mushroom mushroom;
  const ReconstructedSurface closed = mushroom.Reconstruct(false);
  const ReconstructedSurface carved = mushroom.Reconstruct(true);
  EXPECT_EQ(closed.carved_points, 0);
  EXPECT_GT(carved.carved_points, 100);
  EXPECT_TRUE(test::IsClosedManifold(carved.mesh));
  const double before = AirFilled(closed.mesh), after = AirFilled(carved.mesh);
  EXPECT_GT(before, 0.02);
  EXPECT_LT(after, 0.5 * before) << before;
}

TEST(Carving, NothingKnownNothingCarved) {
  const TriangleMesh ball = test::MakeSphere(20, 3, {0, 0, 20});
  EXPECT_TRUE(FindCarvedBorder(ball, FreeSpace({}, {}, 1), {}, 1, 1).points.empty());
  EXPECT_TRUE(FindCarvedBorder({}, FreeSpace({}, {}, 1), {}, 1, 1).points.empty());
}

// A wall behind a ball, seen past nothing: the ball is not there.
TEST(Carving, BorderLiesWhereSightEnds) {
  PointCloud wall;
  for (int i = 0; i < 120; ++i) {
    for (int j = 0; j < 120; ++j) wall.points.emplace_back(0, 0.5 * i - 30, 0.5 * j);
  }
  wall.normals.assign(wall.points.size(), Eigen::Vector3d::UnitX());
  const FreeSpace free(wall, {{{{300, 0, 25}}, 0, static_cast<int64_t>(wall.points.size())}}, 1);
  const TriangleMesh ball = test::MakeSphere(12, 4, {0, 0, 25});
  const PointCloud border = FindCarvedBorder(ball, free, {}, 1, 0.5);
  ASSERT_GT(border.points.size(), 100u);
  for (size_t i = 0; i < border.points.size(); ++i) {
    EXPECT_NEAR(border.points[i].x(), 1, 1.2);  // the margin before the wall
    EXPECT_GT(border.normals[i].x(), 0.7);
    EXPECT_EQ(border.confidence[i], 0);
  }
  EXPECT_THROW(FindCarvedBorder(ball, free, {}, 0, 1), Error);
}

}  // namespace
}  // namespace lfm
