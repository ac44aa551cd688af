// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/scan_bounce.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sample_data/random.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr int kWidth = 24, kHeight = 20, kFrames = 2;

// Even irradiance 0.1 on a flat sheet of two albedos, each pixel with noise of its own.
ScanBand NoisySheet(float sigma) {
  ScanBand band(kWidth, 5, kHeight, kFrames);
  RandomStream random(1, 2, 3);
  for (int y = 5; y < 5 + kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      ScanGuide& guide = band.Guide(x, y);
      guide.point = V3f(static_cast<float>(x), static_cast<float>(y), 0);
      guide.normal = V3f(0, 0, 1);
      guide.albedo = x < kWidth / 2 ? 0.8f : 0.1f;
      guide.whole = true;
      for (int f = 0; f < kFrames; ++f) {
        band.Direct(x, y)[f] = 0.5f + static_cast<float>(f);
        band.Bounce(x, y)[f] = guide.albedo * (0.1f + sigma * static_cast<float>(random.Normal()));
      }
    }
  }
  return band;
}

TEST(ScanBounce, AveragesTheIrradianceAndKeepsTheAlbedo) {
  constexpr float kSigma = 0.02f;
  const ScanBand band = NoisySheet(kSigma);
  double squares = 0;
  int count = 0;
  for (int y = 5; y < 5 + kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      float out[kFrames];
      AddFilteredBounce(band, x, y, out);
      const float albedo = x < kWidth / 2 ? 0.8f : 0.1f;
      for (int f = 0; f < kFrames; ++f) {
        const double irradiance = (out[f] - 0.5 - f) / albedo;
        squares += (irradiance - 0.1) * (irradiance - 0.1);
        ++count;
      }
    }
  }
  // A fifth in the middle, a third in the corners.
  const double rms = std::sqrt(squares / count);
  EXPECT_LT(rms, 0.3 * kSigma);
  EXPECT_GT(rms, 0.15 * kSigma);
}

TEST(ScanBounce, DoesNotCrossEdgesStepsOrCreases) {
  enum Border { kEdge, kStep, kCrease };
  for (const Border border : {kEdge, kStep, kCrease}) {
    ScanBand band = NoisySheet(0);
    for (int y = 5; y < 5 + kHeight; ++y) {
      for (int x = 12; x < kWidth; ++x) {
        ScanGuide& guide = band.Guide(x, y);
        if (border == kEdge) guide.whole = false;
        if (border == kStep) guide.point.z() = 3;
        if (border == kCrease) guide.normal = V3f(0.6f, 0, 0.8f);
        for (int f = 0; f < kFrames; ++f) band.Bounce(x, y)[f] = 7;
      }
    }
    float out[kFrames];
    AddFilteredBounce(band, 11, 12, out);
    EXPECT_NEAR(out[0], 0.5f + 0.08f, 1e-6f) << border;
    AddFilteredBounce(band, 12, 12, out);
    EXPECT_NEAR(out[0], 0.5f + 7, 1e-5f) << border;
  }
}

TEST(ScanBounce, APixelWithoutOneNormalKeepsWhatItHas) {
  ScanBand band = NoisySheet(0);
  band.Guide(11, 12).normal = V3f(0.5f, 0, 0.5f);
  float out[kFrames];
  AddFilteredBounce(band, 11, 12, out);
  for (int f = 0; f < kFrames; ++f) {
    EXPECT_EQ(out[f], band.Direct(11, 12)[f] + band.Bounce(11, 12)[f]) << f;
  }
}

TEST(ScanBounce, BlackAndEmptyPixelsKeepWhatTheyHave) {
  ScanBand band(3, 0, 3, 1);
  float out = -1;
  AddFilteredBounce(band, 1, 1, &out);
  EXPECT_EQ(out, 0);
  band.Guide(1, 1).whole = true;  // albedo 0
  band.Direct(1, 1)[0] = 0.25f;
  AddFilteredBounce(band, 1, 1, &out);
  EXPECT_EQ(out, 0.25f);
}

}  // namespace
}  // namespace lfm
