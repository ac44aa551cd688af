// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/heldout.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"

namespace lfm {
namespace {

Image Flat(int width, int height, int channels, int level) {
  Image image(width, height, channels, PixelType::kUint8, ColorEncoding::kSrgb);
  std::fill_n(image.Data<uint8_t>(), image.size(), static_cast<uint8_t>(level));
  return image;
}

CalibResult TwoTestPhotos() {
  CalibResult calib;
  for (const char* id : {"a", "train", "b"}) {
    PosedImage photo;
    photo.id = id;
    photo.split = std::string(id) == "train" ? PhotoSplit::kTrain : PhotoSplit::kTest;
    calib.photos.push_back(photo);
  }
  return calib;
}

TEST(ScorePictures, PoolsSquaredErrorsOverForegroundPixels) {
  // Photograph a: 64 x 64 foreground pixels off by 2 levels; b: half as many, off by 8.
  const HeldoutPictures pictures{[](const PosedImage&) { return Flat(64, 64, 3, 100); },
                                 [](const PosedImage& photo) {
                                   Image mask = Flat(64, 64, 1, 255);
                                   if (photo.id == "b")
                                     std::fill_n(mask.Data<uint8_t>(), mask.size() / 2, uint8_t{0});
                                   return mask;
                                 }};
  const PictureOf rendering = [](const PosedImage& photo) {
    return Flat(64, 64, 3, photo.id == "a" ? 102 : 108);
  };
  const HeldoutScores scores =
      ScorePictures(rendering, TwoTestPhotos(), pictures, SilentProgress());
  ASSERT_EQ(scores.photos.size(), 2u);
  const double mse = (4.0 * 2 + 64.0) / 3;
  constexpr double kTolerance_abs = 1e-9;
  EXPECT_NEAR(scores.psnr_db, 10 * std::log10(255 * 255 / mse), kTolerance_abs);
  EXPECT_NEAR(scores.ape, (2.0 * 2 + 8) / 3, kTolerance_abs);
  const double mean_of_photos = 5 * (std::log10(255 * 255 / 4.0) + std::log10(255 * 255 / 64.0));
  EXPECT_NEAR(scores.psnr_mean_of_photos_db, mean_of_photos, kTolerance_abs);
}

TEST(ScorePictures, NamesTheMissingTestSplit) {
  CalibResult calib = TwoTestPhotos();
  for (PosedImage& photo : calib.photos) photo.split = PhotoSplit::kTrain;
  const PictureOf flat = [](const PosedImage&) { return Flat(16, 16, 3, 0); };
  try {
    ScorePictures(flat, calib, {flat, flat}, SilentProgress());
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("\"split\": \"test\""), std::string::npos);
  }
}

}  // namespace
}  // namespace lfm
