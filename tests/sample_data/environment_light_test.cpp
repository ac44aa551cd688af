// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/environment_light.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>

#include "core/error.h"
#include "sample_data/random.h"
#include "tests/sample_data/chi_square.h"
#include "tests/sample_data/test_shapes.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr double kPi = std::numbers::pi;

Image Black(int width, int height) {
  return Image(width, height, 3, PixelType::kFloat32, ColorEncoding::kLinear);
}

EnvironmentMap MapOf(Image image) { return {std::make_shared<const Image>(std::move(image)), 1}; }

// A dim picture with one bright pixel and one black half.
EnvironmentMap Spotty() {
  Image image = Black(24, 12);
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 12; ++x) image.At<float>(x, y, 1) = 0.1f + 0.05f * static_cast<float>(y);
  }
  image.At<float>(17, 3, 0) = 80;
  image.At<float>(17, 3, 1) = 80;
  return MapOf(std::move(image));
}

TEST(EnvironmentLight, HasColumnZeroAtMinusXTheMiddleAtPlusXAndUpAtTheTop) {
  EXPECT_LT((EnvironmentDirection({-0.5f, 7.5f}, 32, 16) - V3f(-1, 0, 0)).norm(), 1e-6);
  EXPECT_LT((EnvironmentDirection({15.5f, 7.5f}, 32, 16) - V3f(1, 0, 0)).norm(), 1e-6);
  EXPECT_LT((EnvironmentDirection({7.5f, 7.5f}, 32, 16) - V3f(0, 1, 0)).norm(), 1e-6);
  EXPECT_LT((EnvironmentDirection({4, -0.5f}, 32, 16) - V3f(0, 0, 1)).norm(), 1e-6);
  RandomStream random(1, 0, 0);
  for (int k = 0; k < 100; ++k) {
    const Eigen::Vector2f pixel(static_cast<float>(random.Uniform(0, 31)),
                                static_cast<float>(random.Uniform(0, 15)));
    const Eigen::Vector2f back = EnvironmentPixel(EnvironmentDirection(pixel, 32, 16), 32, 16);
    EXPECT_LT((back - pixel).norm(), 1e-4);
  }
}

TEST(EnvironmentLight, LooksUpPixelCentresExactlyAndWrapsRound) {
  Image image = Black(8, 4);
  for (size_t i = 0; i < image.size(); ++i) image.Data<float>()[i] = static_cast<float>(i);
  const EnvironmentLight light({}, MapOf(image));
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 8; ++x) {
      const V3f d = EnvironmentDirection({static_cast<float>(x), static_cast<float>(y)}, 8, 4);
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(light.Radiance(d)[c], image.At<float>(x, y, c), 2e-4);
      }
    }
  }
  const V3f seam = EnvironmentDirection({-0.5f, 1}, 8, 4);
  EXPECT_NEAR(light.Radiance(seam)[0], 0.5f * (image.At<float>(0, 1, 0) + image.At<float>(7, 1, 0)),
              1e-3);
}

TEST(EnvironmentLight, DensityIntegratesToOneAndIsPositiveWhereverThereIsLight) {
  const EnvironmentLight light({}, Spotty());
  double sum = 0;
  const int rows = 240, columns = 480;
  for (int i = 0; i < rows; ++i) {
    const double theta = (i + 0.5) / rows * kPi;
    for (int j = 0; j < columns; ++j) {
      const double phi = (j + 0.5) / columns * 2 * kPi;
      const V3f d(static_cast<float>(std::sin(theta) * std::cos(phi)),
                  static_cast<float>(std::sin(theta) * std::sin(phi)),
                  static_cast<float>(std::cos(theta)));
      const float density = light.Density(d);
      if (!light.Radiance(d).isZero()) {
        ASSERT_GT(density, 0);
      }
      sum += density * std::sin(theta);
    }
  }
  EXPECT_NEAR(sum * (kPi / rows) * (2 * kPi / columns), 1, 2e-3);
}

TEST(EnvironmentLight, SamplerFollowsItsDensity) {
  Lighting room;
  room.sky = room.wall = V3f(0.2f, 0.2f, 0.2f);
  const EnvironmentLight light(room, Spotty());
  constexpr int kRows = 12, kColumns = 24, kFine = 12, kSamples = 60000;
  std::vector<double> counts(kRows * kColumns), expected(kRows * kColumns);
  for (size_t b = 0; b < counts.size(); ++b) {
    // Bins that do not coincide with pixels.
    const int r = static_cast<int>(b) / kColumns, c = static_cast<int>(b) % kColumns;
    for (int f = 0; f < kFine * kFine; ++f) {
      const double z = 1 - 2 * (r + (f / kFine + 0.5) / kFine) / kRows;
      const double phi = (c + 0.37 + (f % kFine + 0.5) / kFine) / kColumns * 2 * kPi;
      const double s = std::sqrt(1 - z * z);
      const V3f d(static_cast<float>(s * std::cos(phi)), static_cast<float>(s * std::sin(phi)),
                  static_cast<float>(z));
      expected[b] += light.Density(d) * kSamples * 4 * kPi / (kRows * kColumns * kFine * kFine);
    }
  }
  RandomStream random(2, 0, 0);
  double mean = 0;
  for (int s = 0; s < kSamples; ++s) {
    const auto sample = light.Draw(static_cast<float>(random.Bits() >> 40) * 0x1p-24f,
                                   static_cast<float>(random.Bits() >> 40) * 0x1p-24f);
    ASSERT_NEAR(sample.density, light.Density(sample.direction), 1e-3 * sample.density);
    mean += sample.radiance.y() / sample.density / kSamples;
    double turn = std::atan2(sample.direction.y(), sample.direction.x()) / (2 * kPi) * kColumns;
    turn -= 0.37;
    if (turn < 0) turn += kColumns;
    const int r =
        std::clamp(static_cast<int>((1 - sample.direction.z()) / 2 * kRows), 0, kRows - 1);
    counts[static_cast<size_t>(r) * kColumns + static_cast<size_t>(turn) % kColumns] += 1;
  }
  // The bins' edges cut pixels, and midpoints resolve those cuts to about 1 %.
  double chi = 0;
  for (size_t b = 0; b < counts.size(); ++b) {
    chi = std::max(chi, std::abs(counts[b] - expected[b]) /
                            (4.5 * std::sqrt(expected[b] + 1) + 0.06 * expected[b]));
  }
  EXPECT_LT(chi, 1);
  EXPECT_GT(mean, 0);
}

TEST(EnvironmentLight, SamplerPassesTheChiSquareTestAPixel) {
  const EnvironmentMap map = Spotty();
  const EnvironmentLight light({}, map);
  constexpr int kSamples = 50000;
  std::vector<double> counts(24 * 12), expected(24 * 12);
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 24; ++x) {
      const V3f d = EnvironmentDirection({static_cast<float>(x), static_cast<float>(y)}, 24, 12);
      const double area = (std::cos(kPi * y / 12) - std::cos(kPi * (y + 1) / 12)) * 2 * kPi / 24;
      expected[static_cast<size_t>(y) * 24 + x] = light.Density(d) * area * kSamples;
    }
  }
  RandomStream random(3, 0, 0);
  for (int s = 0; s < kSamples; ++s) {
    const auto sample = light.Draw(static_cast<float>(random.Bits() >> 40) * 0x1p-24f,
                                   static_cast<float>(random.Bits() >> 40) * 0x1p-24f);
    const Eigen::Vector2f p = EnvironmentPixel(sample.direction, 24, 12);
    const int x = std::clamp(static_cast<int>(std::lround(p.x())), 0, 23);
    const int y = std::clamp(static_cast<int>(std::lround(p.y())), 0, 11);
    counts[static_cast<size_t>(y) * 24 + x] += 1;
  }
  EXPECT_GT(ChiSquareTest(counts, expected), kSignificance);
}

TEST(EnvironmentLight, UnusablePicturesAreRefused) {
  const Lighting room;
  EXPECT_THROW(EnvironmentLight(room, MapOf(Black(8, 4))), Error);
  Image bad = Black(8, 4);
  bad.At<float>(3, 2, 1) = std::nanf("");
  EXPECT_THROW(EnvironmentLight(room, MapOf(bad)), Error);
  bad.At<float>(3, 2, 1) = -1;
  EXPECT_THROW(EnvironmentLight(room, MapOf(bad)), Error);
  EXPECT_THROW(
      EnvironmentLight(room, MapOf(Image(8, 4, 3, PixelType::kUint8, ColorEncoding::kSrgb))),
      Error);
  EnvironmentMap dark = UniformEnvironment({1, 1, 1});
  dark.gain = 0;
  EXPECT_THROW(EnvironmentLight(room, dark), Error);
  EXPECT_THROW(ReadEnvironmentMap("no/such/sky.hdr", 1), Error);
}

TEST(EnvironmentLight, IsReadFromExrAndHdr) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "lfm_environment";
  std::filesystem::create_directories(folder);
  Image image = Black(8, 4);
  image.At<float>(2, 1, 0) = 3.5f;
  WriteImage(image, folder / "sky.exr");
  WriteImage(image, folder / "sky.hdr");
  WriteImage(Black(8, 4), folder / "night.exr");
  for (const char* name : {"sky.exr", "sky.hdr"}) {
    const EnvironmentMap map = ReadEnvironmentMap(folder / name, 2);
    EXPECT_NEAR(map.image->At<float>(2, 1, 0), 3.5f, 0.02f);
    EXPECT_EQ(map.gain, 2);
  }
  EXPECT_THROW(ReadEnvironmentMap(folder / "night.exr", 1), Error);
  std::filesystem::remove_all(folder);
}

TEST(EnvironmentLight, BuiltInStudioShinesFromAboveWithinItsRange) {
  const EnvironmentMap map = MakeStudioEnvironment(128);
  float least = 1e9f, most = 0;
  for (size_t i = 0; i < map.image->size(); ++i) {
    least = std::min(least, map.image->Data<float>()[i]);
    most = std::max(most, map.image->Data<float>()[i]);
  }
  EXPECT_GT(least, 0.02f);
  EXPECT_LT(most, 15);
  EXPECT_GT(most, 5);
  const EnvironmentLight light({}, map);
  EXPECT_GT(light.Radiance({0, 0, 1}).x(), light.Radiance({0, 0, -1}).x());
}

}  // namespace
}  // namespace lfm
