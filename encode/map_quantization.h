// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "encode/quantization.h"
#include "encode/shared_samples.h"

namespace lfm {

/// One quantised term of a vertex.
struct TermMaps {
  MapRange surface_range, view_range;
  std::vector<uint8_t> surface_codes;  ///< M, samples of the ring's triangles one after the other
  std::vector<uint8_t> view_codes;     ///< 3 q + channel, of the directions of the view map's grid
};

/// The values that a map takes, and 0.
struct Extent {
  float low = 0, high = 0;
  float max_abs() const { return -low > high ? -low : high; }
  void Include(float value) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
};

/// Of a surface map over a ring of patches (`edge_samples` of each), and of the completions beyond
/// the hypotenuse that the gutters will hold.
Extent SurfaceExtent(std::span<const int> edge_samples, std::span<const float> values);

/// Quantises the surface map values * factor with the range of extent * factor; codes at shared
/// samples are equal on both sides where the values are (MakeContinuous). `shared` lists those of
/// the ring.
void QuantizeSurface(std::span<const int> edge_samples, const SharedSamples& shared,
                     std::span<const float> values, const Extent& extent, double factor,
                     TermMaps& maps);

/// Quantises a view map with 3 N values, channels outer.
void QuantizeView(std::span<const float> values, TermMaps& maps);

}  // namespace lfm
