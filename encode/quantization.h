// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "encode/model.h"

namespace lfm {

/// How the strength of a term u v^T is shared between its two maps (Chen 2002, Appendix):
///   u' = surface u,  v' = view v,  surface * view = 1
/// such that max|u'| = max|v'| = sqrt(max|u| max|v|). For unit u, v and a singular value lambda
/// inside one of them that is the appendix's alpha = sqrt(max_u lambda / max_v), and both maxima
/// are sqrt(lambda max_u max_v): the split that minimises the largest quantisation error.
struct AlphaSplit {
  double surface = 1, view = 1;
};
/// Maxima must be finite and >= 0; where one is zero the split is 1, 1.
AlphaSplit SplitAlpha(double max_abs_u, double max_abs_v);

/// The range of a surface map with values in [low, high] (0 need not lie inside; it is added). Zero
/// is a code exactly, since maps are zero at the far edges of a vertex ring, where they end. Codes
/// of the values keep 2 away from 0 and 255: the completion b + c - a of rounded codes then needs
/// no clamping (docs/formats.md). low = high = 0 gives scale 0.
MapRange SurfaceRange(float low, float high);
/// The code that decodes to zero: in a surface range exactly.
uint8_t ZeroCode(const MapRange& range);

/// The range of a view map: [low, high] on codes 0 to 255. low = high gives scale 0.
MapRange ViewRange(float low, float high);

/// The nearest code, clamped; 0 where the scale is 0 or the value is NaN.
uint8_t QuantizeValue(const MapRange& range, float value);
/// The codes of values * factor, in float32: a value within some 1e-4 codes of the middle between
/// two may get the other.
void QuantizeValues(const MapRange& range, float factor, std::span<const float> values,
                    uint8_t* codes);
/// `scale * code / 255 + bias`; fractional codes are interpolated codes.
inline float DecodeValue(const MapRange& range, float code) {
  return range.scale * code / 255 + range.bias;
}

}  // namespace lfm
