// SPDX-License-Identifier: BSD-3-Clause
#include "core/image_metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "test_files.h"

namespace lfm {
namespace {

Image Flat(int width, int height, int channels, uint8_t value) {
  Image image(width, height, channels, PixelType::kUint8, ColorEncoding::kSrgb);
  std::fill_n(image.Data<uint8_t>(), image.size(), value);
  return image;
}

Image Noise(int width, int height, int seed) {
  Image image = Flat(width, height, 3, 0);
  std::mt19937 random(seed);
  for (size_t i = 0; i < image.size(); ++i) image.Data<uint8_t>()[i] = random() % 256;
  return image;
}

TEST(ImageMetrics, AreAsComputedByHand) {
  Image image = Flat(2, 2, 3, 100), reference = Flat(2, 2, 3, 100);
  Image mask = Flat(2, 2, 1, 0);
  mask.At<uint8_t>(0, 0) = 255;
  mask.At<uint8_t>(1, 0) = 128;  // counts
  mask.At<uint8_t>(0, 1) = 127;  // does not
  image.At<uint8_t>(0, 0, 0) = 106;
  image.At<uint8_t>(1, 0, 2) = 97;
  image.At<uint8_t>(0, 1, 1) = 255;
  const ImageDifference difference = CompareImages(image, reference, mask);
  EXPECT_EQ(difference.pixels, 2);
  EXPECT_DOUBLE_EQ(difference.mse, (36.0 + 9.0) / 6);
  EXPECT_DOUBLE_EQ(difference.ape, (6.0 + 3.0) / 6);
  EXPECT_DOUBLE_EQ(difference.psnr_db, 10 * std::log10(255 * 255 / 7.5));
}

TEST(ImageMetrics, AgreeExactlyAtTheCeiling) {
  const Image image = Noise(30, 20, 1);
  const ImageDifference difference = CompareImages(image, image, Flat(30, 20, 1, 255));
  EXPECT_EQ(difference.mse, 0);
  EXPECT_EQ(difference.ape, 0);
  EXPECT_EQ(difference.psnr_db, 99);
  EXPECT_NEAR(difference.ssim, 1, 1e-12);
}

TEST(ImageMetrics, PsnrHasACeilingAndRefusesNan) {
  EXPECT_EQ(PsnrFromMse(0), 99);
  EXPECT_EQ(PsnrFromMse(1e-300), 99);
  EXPECT_NEAR(PsnrFromMse(1), 48.1308036, 1e-6);
  EXPECT_NEAR(PsnrFromMse(255.0 * 255.0), 0, 1e-12);
  ExpectError([] { PsnrFromMse(std::nan("")); }, "finite");
  ExpectError([] { PsnrFromMse(-1); }, "finite");
  ExpectError([] { PsnrFromMse(std::numeric_limits<double>::infinity()); }, "finite");
}

/// SSIM straight from its definition: one two-dimensional weighted window a pixel.
double SsimByDefinition(const Image& image, const Image& reference, const Image& mask) {
  const auto luminance = [&](const Image& i, int x, int y) {
    const Image& source = mask.At<uint8_t>(x, y) >= 128 ? i : reference;
    return 0.2126 * source.At<uint8_t>(x, y, 0) + 0.7152 * source.At<uint8_t>(x, y, 1) +
           0.0722 * source.At<uint8_t>(x, y, 2);
  };
  double sum = 0;
  int count = 0;
  for (int cy = 0; cy < image.height(); ++cy) {
    for (int cx = 0; cx < image.width(); ++cx) {
      if (mask.At<uint8_t>(cx, cy) < 128) continue;
      double w = 0, a = 0, b = 0;
      const auto each = [&](const auto& use) {
        for (int y = std::max(0, cy - 5); y <= std::min(image.height() - 1, cy + 5); ++y) {
          for (int x = std::max(0, cx - 5); x <= std::min(image.width() - 1, cx + 5); ++x) {
            const double r2 = (x - cx) * (x - cx) + (y - cy) * (y - cy);
            use(std::exp(-r2 / (2 * 1.5 * 1.5)), luminance(image, x, y),
                luminance(reference, x, y));
          }
        }
      };
      each([&](double weight, double va, double vb) {
        w += weight;
        a += weight * va;
        b += weight * vb;
      });
      a /= w;
      b /= w;
      double aa = 0, bb = 0, ab = 0;
      each([&](double weight, double va, double vb) {
        aa += weight / w * (va - a) * (va - a);
        bb += weight / w * (vb - b) * (vb - b);
        ab += weight / w * (va - a) * (vb - b);
      });
      const double c1 = 6.5025, c2 = 58.5225;
      sum += (2 * a * b + c1) * (2 * ab + c2) / ((a * a + b * b + c1) * (aa + bb + c2));
      ++count;
    }
  }
  return sum / count;
}

TEST(ImageMetrics, SsimMatchesItsDefinition) {
  constexpr double kSsim_abs = 1e-9;
  const Image reference = Noise(40, 31, 2);
  Image image = reference;
  std::mt19937 random(3);
  for (size_t i = 0; i < image.size(); ++i) {
    uint8_t& v = image.Data<uint8_t>()[i];
    v = static_cast<uint8_t>(std::min(255, v / 2 + static_cast<int>(random() % 60)));
  }
  Image disc = Flat(40, 31, 1, 0);
  for (int y = 0; y < 31; ++y) {
    for (int x = 0; x < 40; ++x) {
      if ((x - 24) * (x - 24) + (y - 15) * (y - 15) < 90) disc.At<uint8_t>(x, y) = 255;
    }
  }
  Image corner = Flat(40, 31, 1, 0);
  corner.At<uint8_t>(39, 0) = 255;
  for (const Image& mask : {disc, corner, Flat(40, 31, 1, 255)}) {
    const double ssim = CompareImages(image, reference, mask).ssim;
    EXPECT_NEAR(ssim, SsimByDefinition(image, reference, mask), kSsim_abs);
    EXPECT_LT(ssim, 0.995);
  }
}

TEST(ImageMetrics, BackgroundDoesNotCount) {
  const Image reference = Noise(30, 30, 4);
  Image image = Noise(30, 30, 5);
  Image mask = Flat(30, 30, 1, 0);
  for (int y = 10; y < 20; ++y) {
    for (int x = 10; x < 20; ++x) mask.At<uint8_t>(x, y) = 255;
  }
  const ImageDifference before = CompareImages(image, reference, mask);
  for (int x = 0; x < 30; ++x) image.At<uint8_t>(x, 9, 1) ^= 0xff;
  const ImageDifference after = CompareImages(image, reference, mask);
  EXPECT_EQ(before.mse, after.mse);
  EXPECT_EQ(before.ssim, after.ssim);
}

TEST(ImageMetrics, RefusePicturesThatCannotBeCompared) {
  const Image a = Flat(4, 4, 3, 1), mask = Flat(4, 4, 1, 255);
  ExpectError([&] { CompareImages(a, Flat(5, 4, 3, 1), mask); }, "differ in size");
  ExpectError([&] { CompareImages(a, a, Flat(4, 5, 1, 255)); }, "differ in size");
  ExpectError([&] { CompareImages(a, Flat(4, 4, 1, 1), mask); }, "three channels");
  ExpectError([&] { CompareImages(a, a, a); }, "mask");
  ExpectError([&] { CompareImages(a, a, Flat(4, 4, 1, 127)); }, "empty");
  ExpectError([&] { CompareImages(ToLinearFloat(a), a, mask); }, "8-bit");
  ExpectError([&] { CompareImages(Image(), Image(), Image()); }, "8-bit");
}

}  // namespace
}  // namespace lfm
