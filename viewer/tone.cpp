// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/tone.h"

#include <cmath>

#include "core/image.h"

namespace lfm {
namespace {

constexpr float kKnee = 0.8f;

float Curve(ToneCurve curve, float linear) {
  if (curve == ToneCurve::kClip || linear <= kKnee) return linear;
  return kKnee + (1 - kKnee) * (1 - std::exp(-(linear - kKnee) / (1 - kKnee)));
}

}  // namespace

Eigen::Vector3f ApplyTone(const Tone& tone, const Eigen::Vector3f& color) {
  Eigen::Vector3f shown = color.cwiseMax(0.f);
  if (!tone.IsIdentity()) {
    const auto factor = static_cast<float>(std::exp2(tone.exposure_stops));
    for (float& channel : shown) {
      channel = SrgbFromLinear(Curve(tone.curve, factor * LinearFromSrgb(channel)));
    }
  }
  return shown.cwiseMin(1.f);
}

Image ShowLinear(const Tone& tone, const Image& linear) {
  const float factor = static_cast<float>(std::exp2(tone.exposure_stops));
  Image shown = linear;
  float* values = shown.Data<float>();
  for (size_t i = 0; i < shown.size(); ++i) values[i] = Curve(tone.curve, factor * values[i]);
  return ToSrgb8(shown);
}

}  // namespace lfm
