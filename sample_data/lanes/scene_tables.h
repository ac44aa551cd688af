// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "sample_data/lanes/layer_lookup.h"

namespace lfm {

/// A scene's surfaces as plain arrays, for lanes to gather from. World frame, mm.
struct SceneTables {
  /// kVertexStride a vertex: position (3), normal (3), texture coordinates (2); painted diffuse
  /// (3), coat (3), roughness, nothing.
  const float* vertices = nullptr;
  const int32_t* triangles = nullptr;  ///< three vertices each, counted over all geometries
  /// kGeometryInts a geometry: first triangle, kind of material, bits as below.
  const int32_t* geometry_ints = nullptr;
  /// kGeometryFloats a geometry: diffuse (3), specular (3), exponent, roughness along and across,
  /// index, absorption (3).
  const float* geometry_floats = nullptr;
  const float* patches = nullptr;  ///< kPatchFloats a patch of the set: origin (3), normal (3)
  LayerTables layers;
};
inline constexpr int kVertexStride = 16, kGeometryInts = 4, kGeometryFloats = 16, kPatchFloats = 8;

/// Bits of a geometry: its paint stands at the vertices; it is the set, two triangles a patch; its
/// colours are looked up point by point, by TracedScene; its tangent follows the texture
/// coordinates where it is brushed.
inline constexpr int32_t kPainted = 1, kIsPatch = 2, kLookedUp = 4, kHasCoordinates = 8;

/// All light as plain arrays.
struct LightTables {
  int lamps = 0;
  const float* lamp = nullptr;  ///< kLampFloats a lamp
  int parallel = 0;
  const float* directional = nullptr;  ///< kParallelFloats each: towards it (3), irradiance (3)
  bool room_is_black = true;
  float sky[3] = {}, wall[3] = {}, ground[3] = {};
  // The environment map; pixels null: none.
  int width = 0, height = 0;
  float gain = 1;
  const float* pixels = nullptr;   ///< RGB
  const float* rows = nullptr;     ///< cumulative, height + 1
  const float* columns = nullptr;  ///< cumulative a row, width + 1 each
  const float* density = nullptr;  ///< 1/sr a pixel
};
/// Of a lamp: center, half_u, half_v, normal, radiance (3 each), area, 1/|half_u|^2, 1/|half_v|^2.
inline constexpr int kLampFloats = 24, kParallelFloats = 8;

}  // namespace lfm
