// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "core/image.h"

namespace lfm {

/// How light beyond what a screen shows is brought back to it.
enum class ToneCurve {
  kClip,  ///< cut off, a channel at a time
  kSoft,  ///< rolled off from 0.8 on: 0.8 + 0.2 (1 - exp(-(x - 0.8) / 0.2))
};

/// How a model's colours are shown: linear light times 2^exposure_stops, through the curve.
struct Tone {
  double exposure_stops = 0;  ///< [-10, 10]
  ToneCurve curve = ToneCurve::kClip;

  /// Whether colours in [0, 1] stay what they are, to the bit.
  bool IsIdentity() const { return exposure_stops == 0 && curve == ToneCurve::kClip; }
};

/// An sRGB-coded colour as it is shown, sRGB-coded in [0, 1]. Colours below 0 are 0; those above 1
/// are light that the curve, or a negative exposure, brings back.
Eigen::Vector3f ApplyTone(const Tone& tone, const Eigen::Vector3f& color);
/// A linear float picture of one or three channels as it is shown, 8-bit sRGB with as many.
Image ShowLinear(const Tone& tone, const Image& linear);

}  // namespace lfm
