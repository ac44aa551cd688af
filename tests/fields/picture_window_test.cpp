// SPDX-License-Identifier: BSD-3-Clause
#include "fields/picture_window.h"

#include <gtest/gtest.h>

#include "tests/fields/field_files.h"

namespace lfm::testing {
namespace {

Image Ramp(int width, int height) {
  return FloatPicture(width, height, 1,
                      [&](int x, int y, int) { return static_cast<float>(y * width + x); });
}

TEST(PictureWindow, CropComesBeforeBlocksOfPixels) {
  const PictureWindow window =
      MakeWindow(10, 8, {.reduce = 2, .crop_left = 3, .crop_top = 1, .crop_width = 5}, "x");
  EXPECT_EQ(window.width, 2);   // the fifth column is left out
  EXPECT_EQ(window.height, 3);  // the seventh row too
  const PictureColumn column = ReadColumn(Ramp(10, 8), {}, window, "x");
  ASSERT_EQ(column.values.size(), 6u);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 2; ++x) {
      const int first = (1 + 2 * y) * 10 + 3 + 2 * x;
      EXPECT_EQ(column.values[static_cast<size_t>(y * 2 + x)],
                static_cast<float>(first + first + 1 + first + 10 + first + 11) / 4);
    }
  }
}

TEST(PictureWindow, BlocksAverageWhatCountsAlone) {
  Image mask(4, 2, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  mask.At<uint8_t>(0, 0) = 128;
  mask.At<uint8_t>(1, 1) = 255;
  mask.At<uint8_t>(2, 0) = 127;
  const PictureWindow window = WithMask(MakeWindow(4, 2, {.reduce = 2}, "x"), mask, "x");
  EXPECT_EQ(window.point_counts, (std::vector<uint8_t>{1, 0}));
  const PictureColumn column = ReadColumn(Ramp(4, 2), {}, window, "x");
  EXPECT_EQ(column.values, (std::vector<float>{(0 + 5) / 2.0F, 0}));
}

TEST(PictureWindow, MasksOfEveryTypeAreCutAtHalf) {
  Image deep(2, 1, 1, PixelType::kUint16, ColorEncoding::kLinear);
  deep.At<uint16_t>(0, 0) = 32767;
  deep.At<uint16_t>(1, 0) = 32768;
  Image colour(2, 1, 4, PixelType::kUint8, ColorEncoding::kSrgb);
  for (int c = 0; c < 4; ++c) colour.At<uint8_t>(1, 0, c) = 255;
  colour.At<uint8_t>(0, 0, 3) = 255;  // opaque black
  const Image real = FloatPicture(2, 1, 1, [](int x, int, int) { return x == 0 ? 0.49F : 0.5F; });
  for (const Image& mask : {deep, colour, real}) {
    const PictureWindow window = WithMask(MakeWindow(2, 1, {}, "x"), mask, "x");
    EXPECT_EQ(window.point_counts, (std::vector<uint8_t>{0, 1}));
  }
}

TEST(PictureWindow, ThePointsCameraSeesTheSameDirections) {
  Camera camera;
  camera.width = 100;
  camera.height = 80;
  camera.fx = 90;
  camera.fy = 95;
  camera.cx = 48.3;
  camera.cy = 41.1;
  camera.k1 = -0.1;
  const PictureWindow window =
      MakeWindow(100, 80, {.reduce = 3, .crop_left = 10, .crop_top = 5, .crop_width = 61}, "x");
  const Camera points = CameraOfWindow(camera, window);
  EXPECT_EQ(points.width, 20);
  EXPECT_EQ(points.height, 25);
  // The middle of a block of three pixels is its second one.
  for (const Eigen::Vector2d& point : {Eigen::Vector2d(0, 0), Eigen::Vector2d(19, 7)}) {
    const Eigen::Vector2d pixel(10 + 3 * point.x() + 1, 5 + 3 * point.y() + 1);
    EXPECT_LT((Unproject(points, point) - Unproject(camera, pixel)).norm(), 1e-12);
  }
}

TEST(PictureWindow, WhatLeavesNothingIsAnError) {
  ExpectErrorWith({"x", "leaves the pictures", "4 x 3"},
                  [] { MakeWindow(4, 3, {.crop_left = 4}, "x"); });
  ExpectErrorWith({"leaves the pictures"}, [] { MakeWindow(4, 3, {.crop_width = 5}, "x"); });
  ExpectErrorWith({"leaves the pictures"},
                  [] { MakeWindow(4, 3, {.crop_top = 1, .crop_height = 3}, "x"); });
  ExpectErrorWith({"leaves the pictures"}, [] { MakeWindow(4, 3, {.crop_left = -1}, "x"); });
  ExpectErrorWith({"leaves the pictures"}, [] { MakeWindow(4, 3, {.reduce = 0}, "x"); });
  ExpectErrorWith({"leave nothing", "reduce less"}, [] { MakeWindow(4, 3, {.reduce = 4}, "x"); });
  const Image black(4, 3, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  ExpectErrorWith({"x", "no pixel that counts"},
                  [&] { WithMask(MakeWindow(4, 3, {}, "x"), black, "x"); });
  // White outside the crop does not help.
  Image corner = black;
  corner.At<uint8_t>(0, 0) = 255;
  ExpectErrorWith({"no pixel that counts"},
                  [&] { WithMask(MakeWindow(4, 3, {.crop_left = 1}, "x"), corner, "x"); });
  EXPECT_NO_THROW(WithMask(MakeWindow(4, 3, {}, "x"), corner, "x"));
}

}  // namespace
}  // namespace lfm::testing
