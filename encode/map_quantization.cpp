// SPDX-License-Identifier: BSD-3-Clause
#include "encode/map_quantization.h"

#include <algorithm>

#include "resample/light_field.h"

namespace lfm {

Extent SurfaceExtent(std::span<const int> edge_samples, std::span<const float> values) {
  Extent extent;
  for (const float value : values) extent.Include(value);
  const float* patch = values.data();
  for (const int n : edge_samples) {
    for (int i = 0; i <= n - 2; ++i) {
      const int j = n - 2 - i;
      extent.Include(patch[PatchSampleIndex(n, i + 1, j)] + patch[PatchSampleIndex(n, i, j + 1)] -
                     patch[PatchSampleIndex(n, i, j)]);
    }
    patch += PatchSampleCount(n);
  }
  return extent;
}

void QuantizeSurface(std::span<const int> edge_samples, const SharedSamples& shared,
                     std::span<const float> values, const Extent& extent, double factor,
                     TermMaps& maps) {
  const auto scale = static_cast<float>(factor);
  maps.surface_range = SurfaceRange(extent.low * scale, extent.high * scale);
  maps.surface_codes.resize(values.size());
  for (size_t row = 0; row < values.size(); ++row) {
    maps.surface_codes[row] = QuantizeValue(maps.surface_range, values[row] * scale);
  }
  std::vector<uint8_t*> patches;
  uint8_t* patch = maps.surface_codes.data();
  for (const int n : edge_samples) {
    patches.push_back(patch);
    patch += PatchSampleCount(n);
  }
  MakeCodesContinuous(shared, 1, patches);
}

void QuantizeView(std::span<const float> values, TermMaps& maps) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  maps.view_range = ViewRange(*low, *high);
  const size_t directions = values.size() / 3;
  maps.view_codes.resize(values.size());
  for (size_t channel = 0; channel < 3; ++channel) {
    for (size_t q = 0; q < directions; ++q) {
      maps.view_codes[3 * q + channel] =
          QuantizeValue(maps.view_range, values[channel * directions + q]);
    }
  }
}

}  // namespace lfm
