// SPDX-License-Identifier: BSD-3-Clause
#include "resample/photo_depth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/pixel_directions.h"
#include "test_scenes.h"

namespace lfm {
namespace {

Camera PlainCamera(int width, int height, double focal_px) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = focal_px;
  camera.cx = (width - 1) / 2.0;
  camera.cy = (height - 1) / 2.0;
  return camera;
}

TEST(RenderDepth, PixelsWhereTheLensFoldsSeeNothing) {
  Camera camera = test::TestCamera(160, 120, 100);
  camera.k1 = -0.5, camera.k2 = camera.k3 = camera.p1 = camera.p2 = 0;
  const Pose pose = LookAt({0, -60, 0}, {0, 0, 0}, {0, 0, 1});
  const TriangleMesh sphere = test::Sphere({0, 0, 0}, 58, 3);
  const DepthMap map = RenderDepth(sphere, RayScene(sphere), camera, PixelDirections(camera), pose);
  EXPECT_TRUE(std::isinf(map.At(0, 0)));
  EXPECT_NEAR(map.At(80, 60), 2, 0.5);
}

TEST(RenderDepth, IsTheCamerasZOfASphere) {
  const Camera camera = test::TestCamera(160, 120, 200);
  const Pose pose = LookAt({0, -200, 30}, {0, 0, 0}, {0, 0, 1});
  const TriangleMesh sphere = test::Sphere({0, 0, 0}, 40, 5);
  const DepthMap map = RenderDepth(sphere, RayScene(sphere), camera, PixelDirections(camera), pose);
  const Eigen::Vector3d center = pose * Eigen::Vector3d(0, 0, 0);
  int hits = 0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray = Unproject(camera, {double(x), double(y)});
      const double along = ray.dot(center);
      const double inside = 40.0 * 40.0 - (center.squaredNorm() - along * along);
      if (std::abs(inside) < 40) continue;  // within a facet of the silhouette
      if (inside < 0) {
        EXPECT_TRUE(std::isinf(map.At(x, y)));
        continue;
      }
      EXPECT_NEAR(map.At(x, y), (along - std::sqrt(inside)) * ray.z(), 0.15);
      ++hits;
    }
  }
  EXPECT_GT(hits, 3000);
}

/// Depths 100 mm left of column `edge`, `far` right of it.
DepthMap Step(float far, int edge) {
  DepthMap map{20, 15, std::vector<float>(20 * 15, 100.0F)};
  for (int y = 0; y < 15; ++y) {
    for (int x = edge; x < 20; ++x) map.depth[y * 20 + x] = far;
  }
  return map;
}

TEST(FindUsablePixels, KeepsTheMarginOnBothSidesOfAnEdge) {
  const Camera camera = PlainCamera(20, 15, 100);  // 1 mm a pixel at 100 mm
  const float nothing = std::numeric_limits<float>::infinity();
  for (const float far : {110.0F, nothing}) {
    const DepthMap map = Step(far, 10);  // the edge runs at x = 9.5
    for (const double margin : {0.0, 0.5, 1.0, 1.6, 3.0}) {
      const auto usable = FindUsablePixels(map, camera, margin);
      for (int x = 0; x < 20; ++x) {
        const bool shown = std::isfinite(map.At(x, 7));
        const bool expected = shown && std::abs(x - 9.5) >= margin;
        EXPECT_EQ(usable[7 * 20 + x] == PixelUse::kData, expected) << x << " margin " << margin;
      }
    }
  }
}

TEST(FindUsablePixels, SeesEdgesInRowsAndColumns) {
  DepthMap map{15, 20, std::vector<float>(20 * 15, 100.0F)};
  for (int y = 10; y < 20; ++y) {
    for (int x = 0; x < 15; ++x) map.depth[y * 15 + x] = 120;
  }
  const auto usable = FindUsablePixels(map, PlainCamera(15, 20, 100), 1.5);
  for (int y = 0; y < 20; ++y)
    EXPECT_EQ(usable[y * 15 + 3] == PixelUse::kNearEdge, y == 9 || y == 10) << y;
}

TEST(FindUsablePixels, AllowsSteepAndTurningSurfaces) {
  const Camera camera = PlainCamera(20, 15, 100);
  DepthMap map{20, 15, std::vector<float>(20 * 15)};
  for (int y = 0; y < 15; ++y) {
    for (int x = 0; x < 20; ++x) {
      map.depth[y * 20 + x] = static_cast<float>(100 + 5.0 * x + 0.15 * x * x);  // over 78 degrees
    }
  }
  for (const PixelUse use : FindUsablePixels(map, camera, 1.5)) EXPECT_EQ(use, PixelUse::kData);
}

TEST(FindUsablePixels, DefinesEmptyAndTinyMaps) {
  const float nothing = std::numeric_limits<float>::infinity();
  const Camera camera = PlainCamera(1, 1, 100);
  EXPECT_EQ(FindUsablePixels({1, 1, {nothing}}, camera, 2), std::vector{PixelUse::kNearEdge});
  EXPECT_EQ(FindUsablePixels({1, 1, {50.0F}}, camera, 2), std::vector{PixelUse::kData});
}

}  // namespace
}  // namespace lfm
