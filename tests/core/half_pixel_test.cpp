// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "core/camera.h"
#include "core/image.h"

namespace lfm {
namespace {

constexpr double kPlane_mm = 500;

Camera TestCamera() {
  Camera camera;
  camera.width = 64;
  camera.height = 48;
  camera.fx = 80;
  camera.fy = 80;
  camera.cx = 30.3;
  camera.cy = 24.9;
  return camera;
}

/// What a camera sees of a plane at z = 500 mm that is coloured by its own coordinates.
Image PictureOfThePlane(const Camera& camera) {
  Image picture(camera.width, camera.height, 3, PixelType::kFloat32, ColorEncoding::kLinear);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray =
          Unproject(camera, {static_cast<double>(x), static_cast<double>(y)});
      for (int c = 0; c < 2; ++c) {
        picture.At<float>(x, y, c) = static_cast<float>(ray[c] / ray.z() * kPlane_mm);
      }
    }
  }
  return picture;
}

Image AverageBlocks(const Image& picture) {
  Image half(picture.width() / 2, picture.height() / 2, 3, PixelType::kFloat32,
             ColorEncoding::kLinear);
  for (int y = 0; y < half.height(); ++y) {
    for (int x = 0; x < half.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        half.At<float>(x, y, c) =
            0.25f *
            (picture.At<float>(2 * x, 2 * y, c) + picture.At<float>(2 * x + 1, 2 * y, c) +
             picture.At<float>(2 * x, 2 * y + 1, c) + picture.At<float>(2 * x + 1, 2 * y + 1, c));
      }
    }
  }
  return half;
}

void ExpectPointsAreSeenWhereTheyProject(const Camera& camera, const Image& picture) {
  constexpr double kPosition_mm_abs = 1e-3;  // half a pixel would be 3 mm and more
  for (double y = -100; y <= 100; y += 12.5) {
    for (double x = -150; x <= 150; x += 12.5) {
      const auto pixel = Project(camera, {x, y, kPlane_mm});
      ASSERT_TRUE(pixel);
      EXPECT_NEAR(SampleBilinear(picture, pixel->x(), pixel->y(), 0), x, kPosition_mm_abs);
      EXPECT_NEAR(SampleBilinear(picture, pixel->x(), pixel->y(), 1), y, kPosition_mm_abs);
    }
  }
}

TEST(HalfPixel, CameraAndPictureAgree) {
  ExpectPointsAreSeenWhereTheyProject(TestCamera(), PictureOfThePlane(TestCamera()));
}

// Averaging two by two pixels moves no content: the scaled camera must say the same.
TEST(HalfPixel, ResizedCameraAndResizedPictureAgree) {
  ExpectPointsAreSeenWhereTheyProject(ScaleCamera(TestCamera(), 0.5),
                                      AverageBlocks(PictureOfThePlane(TestCamera())));
}

// The field of view is bounded by the borders of the outer pixels, not by their centres: with the
// principal point in the middle of the sensor, rays through opposite borders are mirror images.
TEST(HalfPixel, MiddleOfTheSensorIsHalfASizeLessHalfAPixel) {
  Camera camera = TestCamera();
  camera.cx = (camera.width - 1) / 2.0;
  camera.cy = (camera.height - 1) / 2.0;
  const Eigen::Vector2d first(-0.5, -0.5), last(camera.width - 0.5, camera.height - 0.5);
  EXPECT_TRUE(camera.Contains(first));
  EXPECT_FALSE(camera.Contains(first - Eigen::Vector2d(1e-9, 0)));
  EXPECT_TRUE(camera.Contains(last - Eigen::Vector2d(1e-9, 1e-9)));
  EXPECT_FALSE(camera.Contains(last));
  EXPECT_LT((Unproject(camera, first).head<2>() + Unproject(camera, last).head<2>()).norm(), 1e-12);
}

}  // namespace
}  // namespace lfm
