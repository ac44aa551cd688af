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
  QuantizeValues(maps.surface_range, scale, values, maps.surface_codes.data());
  std::vector<uint8_t*> patches;
  uint8_t* patch = maps.surface_codes.data();
  for (const int n : edge_samples) {
    patches.push_back(patch);
    patch += PatchSampleCount(n);
  }
  MakeCodesContinuous(shared, 1, patches);
}

void QuantizeView(std::span<const float> values, TermMaps& maps) {
  const Eigen::Map<const Eigen::ArrayXf> all(values.data(),
                                             static_cast<Eigen::Index>(values.size()));
  maps.view_range = ViewRange(all.minCoeff(), all.maxCoeff());
  const size_t directions = values.size() / 3;
  std::vector<uint8_t> codes(values.size());
  QuantizeValues(maps.view_range, 1, values, codes.data());
  maps.view_codes.resize(values.size());
  const uint8_t* __restrict from = codes.data();
  uint8_t* __restrict to = maps.view_codes.data();
  for (size_t q = 0; q < directions; ++q) {
    to[3 * q] = from[q];
    to[3 * q + 1] = from[directions + q];
    to[3 * q + 2] = from[2 * directions + q];
  }
}

}  // namespace lfm
