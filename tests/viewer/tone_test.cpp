// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/tone.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lfm {
namespace {

constexpr double kCode_abs = 2e-6;  // of sRGB-coded values: the curve and back, in single precision
constexpr double kSlope_abs = 5e-3;  // of differences over kStep
constexpr double kStep = 1e-3;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// IEC 61966-2-1.
double Encode(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}
double Decode(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

double Shown(const Tone& tone, double code) {
  const Eigen::Vector3f shown =
      ApplyTone(tone, Eigen::Vector3f::Constant(static_cast<float>(code)));
  EXPECT_EQ(shown.x(), shown.y());
  EXPECT_EQ(shown.x(), shown.z());
  return shown.x();
}

/// What linear light becomes, linear.
double ShownLight(const Tone& tone, double light) { return Decode(Shown(tone, Encode(light))); }

TEST(Tone, LeavesWhatTheScreenShowsAsItIsToTheBit) {
  EXPECT_TRUE(Tone().IsIdentity());
  EXPECT_FALSE((Tone{0, ToneCurve::kSoft}.IsIdentity()));
  EXPECT_FALSE((Tone{-0.001, ToneCurve::kClip}.IsIdentity()));
  for (int i = 0; i <= 3000; ++i) {
    const float red = static_cast<float>(i) / 3000;
    const Eigen::Vector3f color(red, 1 - red, red * red);
    EXPECT_EQ(ApplyTone({}, color), color) << i;
  }
  const Eigen::Vector3f extremes(std::numeric_limits<float>::denorm_min(), std::nextafter(1.f, 0.f),
                                 1);
  EXPECT_EQ(ApplyTone({}, extremes), extremes);
}

TEST(Tone, ExposureMultipliesLinearLight) {
  for (const double stops : {-10.0, -2.5, -1.0, 0.5, 1.0, 3.0, 10.0}) {
    int below_white = 0;
    for (int i = 0; i <= 100; ++i) {
      const double code = i / 100.0, light = std::exp2(stops) * Decode(code);
      EXPECT_NEAR(Shown({stops, ToneCurve::kClip}, code), std::min(1.0, Encode(light)), kCode_abs)
          << code << " at " << stops;
      below_white += i > 0 && light < 1;
    }
    EXPECT_GT(below_white, 0) << stops;
  }
}

TEST(Tone, ChannelsAreShownByThemselves) {
  const Eigen::Vector3f color(0.2f, 0.9f, 1.4f);
  for (const ToneCurve curve : {ToneCurve::kClip, ToneCurve::kSoft}) {
    const Tone tone{0.4, curve};
    const Eigen::Vector3f shown = ApplyTone(tone, color);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(shown[c], Shown(tone, color[c])) << c;
  }
}

TEST(Tone, NegativeExposureBringsBackWhatIsBeyondWhite) {
  EXPECT_EQ(Shown({}, 1.5), 1);
  const double light = Decode(1.5);
  ASSERT_GT(light, 2.5);
  EXPECT_NEAR(Shown({-2, ToneCurve::kClip}, 1.5), Encode(light / 4), kCode_abs);
  EXPECT_LT(Shown({-2, ToneCurve::kClip}, 1.5), 0.9);
  // What was different beyond white is different again.
  EXPECT_GT(Shown({-3, ToneCurve::kClip}, 2), Shown({-3, ToneCurve::kClip}, 1.5) + 0.1);
}

TEST(Tone, TheSoftCurveIsItsFormula) {
  for (const double stops : {-1.0, 0.0, 2.0}) {
    const Tone tone{stops, ToneCurve::kSoft};
    for (int i = 0; i <= 150; ++i) {
      const double code = i / 100.0, light = std::exp2(stops) * Decode(code);
      const double expected =
          light <= 0.8 ? light : 0.8 + 0.2 * (1 - std::exp(-(light - 0.8) / 0.2));
      EXPECT_NEAR(Shown(tone, code), Encode(expected), kCode_abs) << code << " at " << stops;
    }
  }
}

TEST(Tone, TheSoftCurveIsIdenticalBelowTheKneeAndSmoothAtIt) {
  const Tone soft{0, ToneCurve::kSoft};
  const double knee = 0.8;
  for (int i = 0; i <= 100; ++i) {
    const double code = i / 100.0 * Encode(knee);
    EXPECT_NEAR(Shown(soft, code), code, kCode_abs) << code;
  }
  const double before = (ShownLight(soft, knee) - ShownLight(soft, knee - kStep)) / kStep;
  const double after = (ShownLight(soft, knee + kStep) - ShownLight(soft, knee)) / kStep;
  EXPECT_NEAR(before, 1, kSlope_abs);
  EXPECT_NEAR(after, 1, kSlope_abs);
  EXPECT_LT((ShownLight(soft, knee + 0.2) - knee) / 0.2, 0.7) << "and bends behind it";
}

TEST(Tone, TheSoftCurveRisesAndStaysBelowWhite) {
  const Tone soft{0, ToneCurve::kSoft};
  double before = -1;
  for (int i = 0; i <= 1500; ++i) {
    const double shown = Shown(soft, i / 1000.0);
    EXPECT_GT(shown, before) << i;
    EXPECT_LT(shown, 1) << i;
    before = shown;
  }
  for (double code = 1.5; code < 1e6;
       code *= 1.5) {  // single precision does not tell it from white
    const double shown = Shown(soft, code);
    EXPECT_GE(shown, before) << code;
    EXPECT_LE(shown, 1) << code;
    before = shown;
  }
}

TEST(Tone, NegativeColoursAreBlackAndHugeOnesWhite) {
  const float huge = std::numeric_limits<float>::max();
  for (const ToneCurve curve : {ToneCurve::kClip, ToneCurve::kSoft}) {
    for (const double stops : {-10.0, 0.0, 10.0}) {
      const Tone tone{stops, curve};
      for (const float negative : {-1e-6f, -0.3f, -1000.f, -huge, -kInfinity}) {
        EXPECT_EQ(Shown(tone, negative), 0) << negative;
      }
      for (const float large : {1e4f, 1e20f, huge, kInfinity}) {
        EXPECT_NEAR(Shown(tone, large), 1, kCode_abs) << large;
        EXPECT_LE(Shown(tone, large), 1) << large;
      }
    }
  }
}

TEST(Tone, ShowsLinearPictures) {
  Image linear(3, 1, 1, PixelType::kFloat32, ColorEncoding::kLinear);
  linear.At<float>(0, 0) = 0.25f;
  linear.At<float>(1, 0) = 3;
  linear.At<float>(2, 0) = -1;
  for (const Tone& tone : {Tone{}, Tone{1, ToneCurve::kClip}, Tone{-1, ToneCurve::kSoft}}) {
    const Image shown = ShowLinear(tone, linear);
    for (int x = 0; x < 2; ++x) {
      const double code = Shown(tone, Encode(linear.At<float>(x, 0)));
      EXPECT_NEAR(shown.At<uint8_t>(x, 0), 255 * code, 0.5 + 1e-3);
    }
    EXPECT_EQ(shown.At<uint8_t>(2, 0), 0);
  }
}

}  // namespace
}  // namespace lfm
