// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/photo_renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/pose.h"
#include "sample_data/camera_path.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

TEST(PixelRays, AgreeWithUnproject) {
  const Camera camera = MakePhotoCamera(240, 180);
  const PixelRays rays(camera);
  for (const auto& offset : kFinePattern) {
    for (int x : {0, 7, 120, 239}) {
      for (int y : {0, 90, 179}) {
        const V3 d = rays.Direction(x, y, offset[0], offset[1]).cast<double>();
        const auto pixel = Project(camera, 100 * d);
        ASSERT_TRUE(pixel);
        EXPECT_NEAR(pixel->x(), x + offset[0], 1e-3);
        EXPECT_NEAR(pixel->y(), y + offset[1], 1e-3);
      }
    }
  }
}

TEST(PixelRays, PatternsAreCenteredAndUseEveryRowAndColumnOnce) {
  const auto check = [](const float(*pattern)[2], int count) {
    double sum_x = 0, sum_y = 0;
    std::vector<int> columns(count), rows(count);
    for (int s = 0; s < count; ++s) {
      sum_x += pattern[s][0];
      sum_y += pattern[s][1];
      ++columns[static_cast<int>((pattern[s][0] + 0.5) * count)];
      ++rows[static_cast<int>((pattern[s][1] + 0.5) * count)];
    }
    EXPECT_NEAR(sum_x, 0, 1e-6);
    EXPECT_NEAR(sum_y, 0, 1e-6);
    EXPECT_EQ(columns, std::vector<int>(count, 1));
    EXPECT_EQ(rows, std::vector<int>(count, 1));
  };
  check(kCoarsePattern, kCoarseSamples);
  check(kFinePattern, kFineSamples);
}

// How far the neighbourhood of `center` is from being its own half-turn image, as checker corners
// are.
double Asymmetry(const Image& image, const Eigen::Vector2d& center) {
  double sum = 0;
  for (int dy = -5; dy <= 5; ++dy) {
    for (int dx = -5; dx <= 5; ++dx) {
      const double difference = SampleBilinear(image, center.x() + dx, center.y() + dy, 0) -
                                SampleBilinear(image, center.x() - dx, center.y() - dy, 0);
      sum += difference * difference;
    }
  }
  return sum;
}

// The rendered place of known world points against Project: a bias of half a pixel, or a row or
// column swapped, would show at once.
TEST(PhotoRenderer, CheckerCornersAppearWhereTheCameraProjectsThem) {
  const Board board = DefaultBoard();
  const SetReflectance reflectance(board);
  const StudioScene scene(nullptr,
                          MakePlateAndTable(board, {Eigen::Matrix3d::Identity(), {0, 0, -5}}));
  Lighting lighting;
  lighting.sky = lighting.wall = Eigen::Vector3f(1, 1, 1);
  const Subject nothing;
  BakeOptions bake;
  bake.gather_rays = 16;
  bake.plate_spacing_mm = 40;
  const BakedLight light = BakeLight(scene, nothing, lighting, reflectance, bake, SilentProgress());
  const CoatShading shading(nothing, lighting, light);
  const Camera camera = MakePhotoCamera(480, 360);
  const Pose pose = LookAt(V3(60, -120, 260), V3(5, 3, 0), V3(0.1, 1, 0.2));
  const RenderedPhoto photo = RenderPhoto(scene, shading, reflectance, PixelRays(camera), pose);
  double mean_x = 0, mean_y = 0;
  int count = 0;
  for (const V3& corner : board.CheckerCorners()) {
    const auto truth = Project(camera, pose * corner);
    if (!truth || truth->x() < 20 || truth->y() < 20 || truth->x() > camera.width - 20 ||
        truth->y() > camera.height - 20) {
      continue;
    }
    // The minimum of the parabola through three places, along each axis.
    Eigen::Vector2d found = *truth;
    constexpr double kStep = 0.4;
    for (int axis = 0; axis < 2; ++axis) {
      Eigen::Vector2d step = Eigen::Vector2d::Zero();
      step[axis] = kStep;
      const double a = Asymmetry(photo.radiance, *truth - step);
      const double b = Asymmetry(photo.radiance, *truth);
      const double c = Asymmetry(photo.radiance, *truth + step);
      ASSERT_GT(a + c - 2 * b, 0);
      found[axis] += kStep * 0.5 * (a - c) / (a + c - 2 * b);
    }
    mean_x += found.x() - truth->x();
    mean_y += found.y() - truth->y();
    ++count;
    EXPECT_NEAR(found.x(), truth->x(), 0.12);
    EXPECT_NEAR(found.y(), truth->y(), 0.12);
  }
  ASSERT_GT(count, 40);
  EXPECT_NEAR(mean_x / count, 0, 0.02);
  EXPECT_NEAR(mean_y / count, 0, 0.02);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) ASSERT_EQ(photo.mask.At<uint8_t>(x, y), 0);
  }
}

}  // namespace
}  // namespace lfm
