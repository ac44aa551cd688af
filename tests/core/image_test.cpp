// SPDX-License-Identifier: BSD-3-Clause
#include "core/image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/parallel.h"
#include "test_files.h"

namespace lfm {
namespace {

// IEC 61966-2-1, written out once more.
double Coded(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}
double Linear(double coded) {
  return coded <= 0.04045 ? coded / 12.92 : std::pow((coded + 0.055) / 1.055, 2.4);
}

Image Filled(int channels, const std::vector<float>& values) {
  Image image(static_cast<int>(values.size()) / channels, 1, channels, PixelType::kFloat32,
              ColorEncoding::kLinear);
  std::copy(values.begin(), values.end(), image.Data<float>());
  return image;
}

TEST(Image, IsZeroFilledAndAddressedByRow) {
  Image image(3, 2, 3, PixelType::kUint16, ColorEncoding::kLinear);
  for (size_t i = 0; i < image.size(); ++i) EXPECT_EQ(image.Data<uint16_t>()[i], 0);
  image.At<uint16_t>(2, 1, 1) = 7;
  EXPECT_EQ(image.Data<uint16_t>()[(1 * 3 + 2) * 3 + 1], 7);
  EXPECT_EQ(image.Bytes().size(), 3u * 2 * 3 * 2);
  EXPECT_TRUE(Image().empty());
}

TEST(Image, RefusesImpossibleSizes) {
  const auto make = [](int w, int h, int c) {
    return [=] { Image(w, h, c, PixelType::kUint8, ColorEncoding::kSrgb); };
  };
  ExpectError(make(0, 1, 1), "sides must be in [1, 65536]");
  ExpectError(make(1, -1, 1), "sides must be in [1, 65536]");
  ExpectError(make(65537, 1, 1), "sides must be in [1, 65536]");
  ExpectError(make(1, 1, 0), "channels");
  ExpectError(make(1, 1, 5), "channels");
  EXPECT_NO_THROW(Image(65536, 1, 1, PixelType::kUint8, ColorEncoding::kSrgb));
}

TEST(Image, RefusesAccessAsAnotherType) {
  Image image(1, 1, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  ExpectError([&] { image.Data<float>(); }, "8-bit picture was accessed as float",
              ErrorKind::kSystem);
}

TEST(Srgb, FollowsTheClosedForm) {
  constexpr double kCurve_abs = 1e-6;
  for (int i = 0; i <= 10000; ++i) {
    const double v = i / 10000.0;
    EXPECT_NEAR(SrgbFromLinear(static_cast<float>(v)), Coded(v), kCurve_abs);
    EXPECT_NEAR(LinearFromSrgb(static_cast<float>(v)), Linear(v), kCurve_abs);
    EXPECT_NEAR(LinearFromSrgb(SrgbFromLinear(static_cast<float>(v))), v, kCurve_abs);
  }
}

TEST(Srgb, IsMirroredBelowZeroAndGoesOnAboveOne) {
  EXPECT_FLOAT_EQ(SrgbFromLinear(-0.25f), -SrgbFromLinear(0.25f));
  EXPECT_FLOAT_EQ(LinearFromSrgb(-0.5f), -LinearFromSrgb(0.5f));
  EXPECT_NEAR(SrgbFromLinear(4), 1.055 * std::pow(4, 1 / 2.4) - 0.055, 1e-6);
  EXPECT_NEAR(LinearFromSrgb(SrgbFromLinear(100)), 100, 1e-4);
}

TEST(ToLinearFloat, MatchesTheCurveForEveryCode) {
  Image eight(256, 1, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  for (int i = 0; i < 256; ++i) eight.At<uint8_t>(i, 0) = static_cast<uint8_t>(i);
  const Image linear = ToLinearFloat(eight);
  EXPECT_EQ(linear.encoding(), ColorEncoding::kLinear);
  for (int i = 0; i < 256; ++i) EXPECT_NEAR(linear.At<float>(i, 0), Linear(i / 255.0), 1e-7);

  for (const ColorEncoding encoding : {ColorEncoding::kLinear, ColorEncoding::kSrgb}) {
    Image sixteen(65536, 1, 1, PixelType::kUint16, encoding);
    for (int i = 0; i < 65536; ++i) sixteen.At<uint16_t>(i, 0) = static_cast<uint16_t>(i);
    const Image values = ToLinearFloat(sixteen);
    for (int i = 0; i < 65536; i += 17) {
      const double v = i / 65535.0;
      EXPECT_NEAR(values.At<float>(i, 0), encoding == ColorEncoding::kSrgb ? Linear(v) : v, 1e-7);
    }
  }
}

TEST(ToLinearFloat, LeavesFloatsExactlyAndAlphaUncurved) {
  const Image in = Filled(1, {-3, 0, 0.1f, 1e6f});
  const Image out = ToLinearFloat(in);
  EXPECT_EQ(in.Bytes(), out.Bytes());
  Image rgba(1, 1, 4, PixelType::kUint8, ColorEncoding::kSrgb);
  for (int c = 0; c < 4; ++c) rgba.At<uint8_t>(0, 0, c) = 128;
  const Image linear = ToLinearFloat(rgba);
  EXPECT_NEAR(linear.At<float>(0, 0, 2), Linear(128 / 255.0), 1e-7);
  EXPECT_NEAR(linear.At<float>(0, 0, 3), 128 / 255.0, 1e-7);
}

TEST(ToSrgb8, RoundsToNearestOverTheWholeRange) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<float> values = {0, 1, 1e-8f, 0.0031308f, 0.00313081f, std::nextafter(1.0f, 0.0f)};
  for (int i = 0; i < 20000; ++i) values.push_back(std::pow(uniform(random), 3.0f));
  const Image out = ToSrgb8(Filled(1, values));
  for (size_t i = 0; i < values.size(); ++i) {
    const double exact = 255 * Coded(values[i]);
    // Within rounding of the border between two levels either is right.
    EXPECT_LE(std::abs(out.Data<uint8_t>()[i] - exact), 0.5 + 1e-4) << values[i];
  }
}

TEST(ToSrgb8, ClampsAndTakesNanForBlack) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const Image out = ToSrgb8(Filled(1, {-1, nan, 2, infinity, -infinity}));
  const std::vector<int> expected = {0, 0, 255, 255, 0};
  for (size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(out.Data<uint8_t>()[i], expected[i]);
}

TEST(ToSrgb8, InvertsToLinearFloatForEveryCode) {
  Image eight(256, 1, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  for (int i = 0; i < 256; ++i) eight.At<uint8_t>(i, 0) = static_cast<uint8_t>(i);
  EXPECT_EQ(ToSrgb8(ToLinearFloat(eight)).Bytes(), eight.Bytes());
}

TEST(ToSrgb8, ConvertsSixteenBitsAndLinearBytes) {
  Image sixteen(2, 1, 1, PixelType::kUint16, ColorEncoding::kLinear);
  sixteen.At<uint16_t>(0, 0) = 6554;  // 0.1
  sixteen.At<uint16_t>(1, 0) = 65535;
  const Image out = ToSrgb8(sixteen);
  EXPECT_EQ(out.At<uint8_t>(0, 0), std::lround(255 * Coded(6554 / 65535.0)));
  EXPECT_EQ(out.At<uint8_t>(1, 0), 255);
  Image eight(1, 1, 2, PixelType::kUint8, ColorEncoding::kLinear);
  eight.At<uint8_t>(0, 0, 0) = eight.At<uint8_t>(0, 0, 1) = 51;  // 0.2; alpha stays
  const Image coded = ToSrgb8(eight);
  EXPECT_EQ(coded.At<uint8_t>(0, 0, 0), std::lround(255 * Coded(0.2)));
  EXPECT_EQ(coded.At<uint8_t>(0, 0, 1), 51);
}

TEST(ToGray, IsLuminanceOfStoredValues) {
  Image rgb(1, 1, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  rgb.At<uint8_t>(0, 0, 0) = 200;
  rgb.At<uint8_t>(0, 0, 1) = 100;
  rgb.At<uint8_t>(0, 0, 2) = 50;
  const Image gray = ToGray(rgb);
  EXPECT_EQ(gray.channels(), 1);
  EXPECT_EQ(gray.At<uint8_t>(0, 0), std::lround(0.2126 * 200 + 0.7152 * 100 + 0.0722 * 50));
  const Image floats = ToGray(Filled(3, {-1, 2, 4}));
  EXPECT_NEAR(floats.At<float>(0, 0), -0.2126 + 0.7152 * 2 + 0.0722 * 4, 1e-6);
  const Image with_alpha = ToGray(Filled(2, {0.5f, 0.1f}));
  EXPECT_EQ(with_alpha.At<float>(0, 0), 0.5f);
}

// Pixel centres are whole numbers: a ramp f(x, y) = x + 10 y is reproduced at any place, so a
// half-pixel shift would show as an error of 0.5 or 5.
TEST(ToRgb8, RepeatsGrayAndLeavesAlphaOut) {
  const std::vector<std::vector<float>> pixels = {
      {1, 0}, {1, 0.25F, 0, 0.5F}, {1, 1, 0, 1, 0, 0}, {1, 0, 0, 0, 1, 1, 0, 0.5F}};
  const std::vector<std::vector<uint8_t>> expected = {{255, 255, 255, 0, 0, 0},
                                                      {255, 255, 255, 0, 0, 0},
                                                      {255, 255, 0, 255, 0, 0},
                                                      {255, 0, 0, 255, 255, 0}};
  for (int channels = 1; channels <= 4; ++channels) {
    const Image rgb = ToRgb8(Filled(channels, pixels[channels - 1]));
    ASSERT_EQ(rgb.channels(), 3);
    EXPECT_EQ(rgb.encoding(), ColorEncoding::kSrgb);
    EXPECT_EQ(std::vector<uint8_t>(rgb.Data<uint8_t>(), rgb.Data<uint8_t>() + rgb.size()),
              expected[channels - 1])
        << channels;
  }
  EXPECT_TRUE(ToRgb8(Image()).empty());
}

TEST(SampleBilinear, HasPixelCentresAtWholeNumbers) {
  Image ramp(5, 4, 2, PixelType::kFloat32, ColorEncoding::kLinear);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 5; ++x) ramp.At<float>(x, y, 1) = static_cast<float>(x + 10 * y);
  }
  EXPECT_EQ(SampleBilinear(ramp, 0, 0, 1), 0);
  EXPECT_EQ(SampleBilinear(ramp, 4, 3, 1), 34);
  for (double y = 0; y <= 3; y += 0.37) {
    for (double x = 0; x <= 4; x += 0.23) {
      EXPECT_NEAR(SampleBilinear(ramp, x, y, 1), x + 10 * y, 1e-5);
    }
  }
  EXPECT_EQ(SampleBilinear(ramp, 2, 2, 0), 0);
}

TEST(SampleBilinear, ClampsToThePicture) {
  Image ramp(3, 2, 1, PixelType::kFloat32, ColorEncoding::kLinear);
  for (int i = 0; i < 6; ++i) ramp.Data<float>()[i] = static_cast<float>(i);
  EXPECT_EQ(SampleBilinear(ramp, -10, -1e300, 0), 0);
  EXPECT_EQ(SampleBilinear(ramp, 1e300, 50, 0), 5);
  EXPECT_EQ(SampleBilinear(ramp, std::nan(""), 0, 0), 0);
}

TEST(ImageConversions, DoNotDependOnTheNumberOfThreads) {
  std::vector<float> values(600000);
  for (size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i % 1009) / 1000;
  Image in(1000, 200, 3, PixelType::kFloat32, ColorEncoding::kLinear);
  std::copy(values.begin(), values.end(), in.Data<float>());
  SetThreadCount(1);
  const Image one = ToSrgb8(in);
  SetThreadCount(7);
  const Image many = ToSrgb8(in);
  SetThreadCount(0);
  EXPECT_EQ(one.Bytes(), many.Bytes());
  EXPECT_EQ(ToLinearFloat(in).Bytes(), in.Bytes());
}

}  // namespace
}  // namespace lfm
