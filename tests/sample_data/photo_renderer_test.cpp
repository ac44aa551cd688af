// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/photo_renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

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

// The plate on its table in even light, without an object.
struct EmptySet {
  Board board = DefaultBoard();
  SetReflectance reflectance{board};
  StudioScene scene{nullptr, MakePlateAndTable(board, {Eigen::Matrix3d::Identity(), {0, 0, -5}})};
  Lighting lighting = EvenLighting();
  Subject nothing;
  BakedLight light =
      BakeLight(scene, nothing, lighting, reflectance, CoarseBake(), SilentProgress());
  CoatShading shading{nothing, lighting, light};
  Camera camera = MakePhotoCamera(480, 360);
  PixelRays rays{camera};
  Pose pose = LookAt(V3(60, -120, 260), V3(5, 3, 0), V3(0.1, 1, 0.2));
  RenderedPhoto photo = RenderPhoto(scene, shading, reflectance, rays, pose);

  static Lighting EvenLighting() {
    Lighting lighting;
    lighting.sky = lighting.wall = Eigen::Vector3f(1, 1, 1);
    return lighting;
  }
  static BakeOptions CoarseBake() {
    BakeOptions bake;
    bake.gather_rays = 16;
    bake.plate_spacing_mm = 40;
    return bake;
  }
};

// Against a thousand places a pixel: a renderer that overlooks what crosses a pixel's rim shows
// pixels that are too small, and calibration would find every tag too small.
TEST(PhotoRenderer, PixelsOfPrintAreMeansOverTheirSquares) {
  const EmptySet set;
  constexpr int kSide = 32;
  const Patch& plate = set.scene.patches()[0];
  const Eigen::Vector3d eye = set.pose.Center();
  double square = 0, sum = 0;
  int edges = 0;
  for (int y = 0; y < set.camera.height; ++y) {
    for (int x = 0; x < set.camera.width; ++x) {
      double albedo = 0, paper = 0;
      bool inside = true;
      V3 middle = V3::Zero();
      for (int s = 0; s < kSide * kSide && inside; ++s) {
        const float dx = (static_cast<float>(s % kSide) + 0.5f) / kSide - 0.5f;
        const float dy = (static_cast<float>(s / kSide) + 0.5f) / kSide - 0.5f;
        const V3 d =
            set.pose.rotation.transpose() * set.rays.Direction(x, y, dx, dy).cast<double>();
        const V3 point = eye - eye.z() / d.z() * d;
        inside = d.z() < 0 && point.head<2>().cwiseAbs().maxCoeff() < set.board.width_mm / 2 - 1;
        if (!inside) break;
        const double here = set.reflectance.Albedo(plate, point.cast<float>());
        albedo += here / (kSide * kSide);
        paper = std::max(paper, here);
        middle += point / (kSide * kSide);
      }
      const bool edge =
          albedo < paper - 1e-6 &&
          std::abs(albedo - set.reflectance.Albedo(plate, middle.cast<float>())) > 1e-6;
      if (!inside || !edge) continue;
      const V3 d = middle - plate.origin;
      const double light = set.light.patches[0].Sample(plate, d.dot(plate.u), d.dot(plate.v)).y();
      const double error =
          set.photo.radiance.At<float>(x, y, 1) * std::numbers::pi / light - albedo;
      EXPECT_NEAR(error, 0, 0.03) << x << " " << y;
      square += error * error;
      sum += error;
      ++edges;
    }
  }
  ASSERT_GT(edges, 1000);
  // Paper's albedo less ink's is 0.565.
  EXPECT_LT(std::sqrt(square / edges), 0.005);
  EXPECT_NEAR(sum / edges, 0, 2e-4);
}

// The rendered place of known world points against Project: a bias of half a pixel, or a row or
// column swapped, would show at once.
TEST(PhotoRenderer, CheckerCornersAppearWhereTheCameraProjectsThem) {
  const EmptySet set;
  const Board& board = set.board;
  const Camera& camera = set.camera;
  const Pose& pose = set.pose;
  const RenderedPhoto& photo = set.photo;
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
