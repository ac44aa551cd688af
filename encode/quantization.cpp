// SPDX-License-Identifier: BSD-3-Clause
#include "encode/quantization.h"

#include <algorithm>
#include <cmath>

#include "encode/map_kernels.h"

namespace lfm {
namespace {

constexpr int kUsedSteps = 249;  // between the extremes of a surface map
constexpr double kMargin = 3;    // codes below the lowest value, before zero is rounded to a code

}  // namespace

AlphaSplit SplitAlpha(double max_abs_u, double max_abs_v) {
  if (!(max_abs_u > 0) || !(max_abs_v > 0)) return {};
  const double surface = std::sqrt(max_abs_v / max_abs_u);
  return {surface, 1 / surface};
}

MapRange SurfaceRange(float low, float high) {
  const double lowest = std::min(low, 0.f), highest = std::max(high, 0.f);
  const double step = (highest - lowest) / kUsedSteps;
  if (!(step > 0)) return {0, 0};
  MapRange range;
  range.scale = static_cast<float>(255 * step);
  const auto zero = static_cast<float>(std::round(kMargin - lowest / step));
  // The decoder's own expression, so that the zero code decodes to 0 and not to a rounding error.
  range.bias = -(range.scale * zero / 255);
  return range;
}

uint8_t ZeroCode(const MapRange& range) { return QuantizeValue(range, 0); }

MapRange ViewRange(float low, float high) {
  if (!(high > low)) return {0, low};
  return {high - low, low};
}

uint8_t QuantizeValue(const MapRange& range, float value) {
  if (!(range.scale > 0)) return 0;
  const double code = (static_cast<double>(value) - range.bias) * 255 / range.scale;
  return code > 0 ? static_cast<uint8_t>(std::min(code, 255.0) + 0.5) : 0;
}

void QuantizeValues(const MapRange& range, float factor, std::span<const float> values,
                    uint8_t* codes) {
  const float steps = range.scale > 0 ? 255 / range.scale : 0;
  kernels::QuantizeCodes(values.data(), static_cast<long>(values.size()), factor, range.bias, steps,
                         codes);
}

}  // namespace lfm
