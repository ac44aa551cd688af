// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/photo_shoot.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sample_data/camera_path.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

// A scene of two planes across the axis of view, in front of each other, with stripes of 8 mm:
// what a pinhole camera sees of it, in closed form, 16 samples a pixel.
RenderedPhoto StripedPlanes(const PixelRays& rays, const Pose& camera_from_world) {
  const Camera& camera = rays.camera();
  RenderedPhoto photo;
  photo.radiance =
      Image(camera.width, camera.height, 3, PixelType::kFloat32, ColorEncoding::kLinear);
  photo.mask = Image(camera.width, camera.height, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  const Pose world_from_camera = camera_from_world.Inverse();
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      double sum = 0;
      for (const auto& offset : kFinePattern) {
        const V3 d =
            world_from_camera.rotation * rays.Direction(x, y, offset[0], offset[1]).cast<double>();
        const V3& eye = world_from_camera.translation;
        // The upper half shows the plane y = 0, the lower one the plane y = 150 behind it.
        const double depth = y < camera.height / 2 ? 0 : 150;
        const V3 p = eye + (depth - eye.y()) / d.y() * d;
        sum += (std::floor(p.x() / 8) / 2 == std::floor(std::floor(p.x() / 8) / 2)) / 16.0;
      }
      for (int c = 0; c < 3; ++c) photo.radiance.At<float>(x, y, c) = static_cast<float>(2 * sum);
      photo.mask.At<uint8_t>(x, y) = x < camera.width / 2 ? 255 : 0;
    }
  }
  return photo;
}

class PhotoShootTest : public testing::Test {
 protected:
  PhotoShootTest() : camera_(MakeCamera()), rays_(camera_), lighting_(MakeStudioLighting()) {}

  static Camera MakeCamera() {
    Camera camera = MakePhotoCamera(160, 120);
    camera.k1 = camera.k2 = camera.k3 = camera.p1 = camera.p2 = 0;
    return camera;
  }
  TakenPhoto Take(const PhotoTrouble& trouble, const PhotoConditions& conditions,
                  PhotoSplit split = PhotoSplit::kTest, Sensor sensor = {1e12, 0}) const {
    const PhotoShoot shoot{
        rays_, trouble, StripedPlanes, StripedPlanes, Covered(), sensor, 0.3f, V3(0, 0, 0), 5};
    return TakePhoto(shoot, 3, pose_, split, conditions);
  }
  // The planes with something drawn over them.
  std::function<PhotoRenderer(const Occluder&)> Covered() const {
    return [this](const Occluder& occluder) {
      return [this, occluder](const PixelRays& rays, const Pose& camera_from_world) {
        RenderedPhoto photo = StripedPlanes(rays, camera_from_world);
        CoverWithOccluder(occluder, lighting_, rays, camera_from_world, photo);
        return photo;
      };
    };
  }
  static double Linear(const Image& image, int x, int y, int c = 0) {
    switch (image.type()) {
      case PixelType::kUint8:
        return LinearFromSrgb(image.At<uint8_t>(x, y, c) / 255.0f);
      case PixelType::kUint16:
        return image.At<uint16_t>(x, y, c) / 65535.0;
      default:
        return image.At<float>(x, y, c);
    }
  }
  // Contrast of the stripes over some rows in the middle.
  static double Contrast(const Image& image, int y0, int y1) {
    double low = 1e9, high = -1e9;
    for (int x = 40; x < 120; ++x) {
      double mean = 0;
      for (int y = y0; y < y1; ++y) mean += Linear(image, x, y) / (y1 - y0);
      low = std::min(low, mean);
      high = std::max(high, mean);
    }
    return high - low;
  }

  Camera camera_;
  PixelRays rays_;
  Lighting lighting_;
  Pose pose_ = LookAt(V3(0, -300, 0), V3(0, 0, 0), V3(0, 0, 1));
};

TEST_F(PhotoShootTest, WithoutTroubleThePictureIsTheRadianceTimesTheExposure) {
  const RenderedPhoto sharp = StripedPlanes(rays_, pose_);
  for (PhotoFormat format :
       {PhotoFormat::kPng8, PhotoFormat::kPng16, PhotoFormat::kExr, PhotoFormat::kJpeg}) {
    PhotoTrouble trouble;
    trouble.format = format;
    const TakenPhoto photo = Take(trouble, {});
    const bool eight = format == PhotoFormat::kPng8 || format == PhotoFormat::kJpeg;
    EXPECT_EQ(photo.picture.type(), eight                           ? PixelType::kUint8
                                    : format == PhotoFormat::kPng16 ? PixelType::kUint16
                                                                    : PixelType::kFloat32);
    EXPECT_EQ(photo.picture.encoding(), eight ? ColorEncoding::kSrgb : ColorEncoding::kLinear);
    for (int y = 0; y < 120; y += 7) {
      for (int x = 0; x < 160; ++x) {
        const double expected = 0.3 * sharp.radiance.At<float>(x, y);
        EXPECT_NEAR(Linear(photo.picture, x, y), expected, eight ? 0.004 : 1e-5);
        EXPECT_NEAR(Linear(photo.clean, x, y), expected, 0.004);
      }
    }
    EXPECT_EQ(photo.mask.Bytes(), sharp.mask.Bytes());
  }
  EXPECT_TRUE(Take({}, {}, PhotoSplit::kTrain).clean.empty());
}

TEST_F(PhotoShootTest, ExposureBalanceAndVignettingMultiplyAndTheCleanPictureIsSpared) {
  PhotoTrouble trouble;
  trouble.format = PhotoFormat::kExr;
  trouble.vignetting_stops = 2;
  PhotoConditions conditions;
  conditions.exposure_stops = -0.5;
  conditions.gains = {1.2f, 1, 0.8f};
  const TakenPhoto photo = Take(trouble, conditions), plain = Take({}, {});
  const RenderedPhoto sharp = StripedPlanes(rays_, pose_);
  for (int y = 0; y < 120; y += 17) {
    for (int x = 0; x < 160; x += 5) {
      for (int c = 0; c < 3; ++c) {
        const double expected = 0.3 * sharp.radiance.At<float>(x, y) * std::exp2(-0.5) *
                                conditions.gains[c] * VignettingGain(camera_, 2, x, y);
        EXPECT_NEAR(photo.picture.At<float>(x, y, c), expected, 1e-5);
      }
    }
  }
  EXPECT_EQ(photo.clean.Bytes(), plain.clean.Bytes());
}

TEST_F(PhotoShootTest, SaturatesAtAFullWellAndKeepsNoiseBelowZeroInFloat) {
  PhotoTrouble trouble;
  trouble.format = PhotoFormat::kExr;
  PhotoConditions conditions;
  conditions.exposure_stops = 2;
  const TakenPhoto photo = Take(trouble, conditions, PhotoSplit::kTest, {2000, 40});
  float low = 1, high = 0;
  for (size_t i = 0; i < photo.picture.size(); ++i) {
    low = std::min(low, photo.picture.Data<float>()[i]);
    high = std::max(high, photo.picture.Data<float>()[i]);
  }
  EXPECT_LT(low, -0.02);
  EXPECT_EQ(high, 1);
}

// Stripes of 8 mm on the plane in focus stay sharp, those 150 mm behind it wash out.
TEST_F(PhotoShootTest, DefocusBlursWhatIsOutOfFocusOnly) {
  PhotoTrouble trouble;
  trouble.format = PhotoFormat::kExr;
  trouble.aperture_mm = 44;
  const TakenPhoto photo = Take(trouble, {}), plain = Take({}, {});
  const double near_sharp = Contrast(plain.picture, 20, 40);
  EXPECT_GT(Contrast(photo.picture, 20, 40), 0.97 * near_sharp);
  EXPECT_LT(Contrast(photo.picture, 80, 100), 0.6 * Contrast(plain.picture, 80, 100));
  EXPECT_EQ(photo.clean.Bytes(), plain.clean.Bytes());
  trouble.focus_error_mm = 150;
  const TakenPhoto behind = Take(trouble, {});
  EXPECT_LT(Contrast(behind.picture, 20, 40), 0.6 * near_sharp);
  EXPECT_GT(Contrast(behind.picture, 80, 100), 0.97 * Contrast(plain.picture, 80, 100));
}

TEST_F(PhotoShootTest, MotionBlursAcrossTheStripesOnly) {
  PhotoTrouble trouble;
  trouble.format = PhotoFormat::kExr;
  PhotoConditions conditions;
  conditions.travel_mm = {16, 0, 0};  // a whole period: nothing is left
  const double sharp = Contrast(Take(trouble, {}).picture, 20, 40);
  EXPECT_LT(Contrast(Take(trouble, conditions).picture, 20, 40), 0.1 * sharp);
  conditions.travel_mm = {0, 16, 0};
  EXPECT_GT(Contrast(Take(trouble, conditions).picture, 20, 40), 0.97 * sharp);
}

TEST_F(PhotoShootTest, WhatIsInTheWayCoversPictureAndMaskButNotTheCleanPicture) {
  PhotoConditions conditions;
  conditions.occluded = true;
  const TakenPhoto photo = Take({}, conditions), plain = Take({}, {});
  int covered = 0, changed = 0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      covered += photo.mask.At<uint8_t>(x, y) != plain.mask.At<uint8_t>(x, y);
      changed += photo.picture.At<uint8_t>(x, y) != plain.picture.At<uint8_t>(x, y);
    }
  }
  EXPECT_GT(changed, 100);
  EXPECT_GT(covered, 20);
  EXPECT_EQ(photo.clean.Bytes(), plain.clean.Bytes());
  // The next photograph has it elsewhere.
  const PhotoTrouble none;
  const PhotoShoot shoot{
      rays_, none, StripedPlanes, StripedPlanes, Covered(), {1e12, 0}, 0.3f, V3(0, 0, 0), 5};
  const TakenPhoto next = TakePhoto(shoot, 4, pose_, PhotoSplit::kTrain, conditions);
  EXPECT_NE(next.mask.Bytes(), photo.mask.Bytes());
}

}  // namespace
}  // namespace lfm
