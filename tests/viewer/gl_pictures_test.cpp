// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/gl_pictures.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/image_metrics.h"
#include "synthetic_model.h"
#include "viewer/orbit_camera.h"

namespace lfm {
namespace {

constexpr int kWidth = 150, kHeight = 110;

/// Where every sample of a pixel and of those round it hits.
Image FullPixels(const Image& coverage) {
  Image mask(coverage.width(), coverage.height(), 1, PixelType::kUint8, ColorEncoding::kLinear);
  for (int y = 1; y < coverage.height() - 1; ++y) {
    for (int x = 1; x < coverage.width() - 1; ++x) {
      bool full = true;
      for (int k = 0; k < 9; ++k) {
        full = full && coverage.At<uint8_t>(x + k % 3 - 1, y + k / 3 - 1) == 255;
      }
      mask.At<uint8_t>(x, y) = full ? 255 : 0;
    }
  }
  return mask;
}

class GlPicturesTest : public testing::Test {
 protected:
  Camera OffCentre(double azimuth) {
    orbit_.azimuth = azimuth;
    Camera camera = PinholeCamera(orbit_, kWidth, kHeight);
    camera.cx += 9.3;
    camera.cy -= 5.7;
    return camera;
  }
  const LightFieldModel model_ = MakeSmoothRandomModel(1, DirectionMap::kHemiOctahedral);
  OrbitCamera orbit_ = FrameMesh(model_.mesh, 0.5, static_cast<double>(kWidth) / kHeight);
};

TEST_F(GlPicturesTest, AgreeWithTheReferenceWhateverTheTiles) {
  const ReferenceRenderer reference(model_);
  for (const int tile_side : {16, 37, 2048}) {
    const GlPictures gl(model_, ViewCoordinates::kPerPixel, tile_side);
    for (const int n : {1, 3}) {
      RenderOptions options;
      options.samples_per_side = n;
      options.background = {0.2f, 0.5f, 0.1f};
      options.linear_light = true;
      const Camera camera = OffCentre(0.7 + n);
      const Pose pose = CameraFromWorld(orbit_);
      const Rendering expected = reference.Render(camera, pose, options, SilentProgress());
      const Rendering drawn = gl.Render(camera, pose, options, SilentProgress());
      const Image mask = FullPixels(expected.coverage);
      EXPECT_GT(CompareImages(drawn.color, expected.color, mask).psnr_db, 45) << tile_side;
      // Silhouettes within a sample: the mean coverage agrees, and background is untouched.
      double covered = 0, expected_covered = 0;
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          covered += drawn.coverage.At<uint8_t>(x, y);
          expected_covered += expected.coverage.At<uint8_t>(x, y);
          if (drawn.coverage.At<uint8_t>(x, y) > 0) continue;
          EXPECT_EQ(drawn.layer.At<uint8_t>(x, y, 3), 0);
          EXPECT_NEAR(drawn.linear_color.At<float>(x, y, 1), LinearFromSrgb(0.5f), 1e-6);
        }
      }
      EXPECT_NEAR(covered, expected_covered, 2e-3 * expected_covered);
    }
  }
}

TEST_F(GlPicturesTest, RefuseALens) {
  const GlPictures gl(model_);
  Camera camera = OffCentre(0);
  camera.k1 = 0.1;
  EXPECT_THROW(gl.Render(camera, CameraFromWorld(orbit_), {}, SilentProgress()), Error);
}

// What EXR files hold: linear light, alpha associated.
TEST_F(GlPicturesTest, LinearPicturesAreThoseInLinearLight) {
  const ReferenceRenderer reference(model_);
  for (const int n : {1, 2}) {
    RenderOptions options;
    options.samples_per_side = n;
    options.background = {0.2f, 0.5f, 0.1f};
    options.linear_light = true;
    const Rendering rendering =
        reference.Render(OffCentre(2), CameraFromWorld(orbit_), options, SilentProgress());
    int partly = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const float alpha = rendering.linear_layer.At<float>(x, y, 3);
        EXPECT_NEAR(alpha * 255, rendering.coverage.At<uint8_t>(x, y), 0.51);
        partly += alpha > 0 && alpha < 1;
        for (int c = 0; c < 3; ++c) {
          const float color = rendering.linear_color.At<float>(x, y, c);
          EXPECT_NEAR(SrgbFromLinear(color) * 255, rendering.color.At<uint8_t>(x, y, c), 0.51);
          const float over = rendering.linear_layer.At<float>(x, y, c) +
                             (1 - alpha) * LinearFromSrgb(options.background[c]);
          EXPECT_NEAR(over, color, 1e-6);
        }
      }
    }
    EXPECT_EQ(partly > 0, n > 1);
  }
}

}  // namespace
}  // namespace lfm
