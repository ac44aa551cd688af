// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "fields/function_rows.h"

namespace lfm {

/// What a column of a field belongs to.
enum class FieldColumns {
  kLights,      ///< parallel light of unit irradiance from a direction
  kCubeTexels,  ///< a texel of a cube map of light, of unit radiance (core/transport_matrix.h)
  kViews,       ///< a direction towards the eye (a surface light field)
};

/// Functions over directions at many points, linear radiance: a reflectance field of one view,
/// light transport to pixels or vertices, or a vertex light field. Every colour channel of a point
/// has a row of its own (Yamada 2009, Section 5 treats channels on their own): row = channel *
/// points + point.
struct Field {
  std::string name;  ///< for messages: the file's or the capture's
  FieldColumns kind = FieldColumns::kLights;
  int64_t points = 0;
  int channels = 1;  ///< 1 or 3
  /// Of the picture whose pixels the points are, row by row from the top; 0 x 0 for vertices.
  int width = 0, height = 0;
  /// Of vertices, mm; empty for pixels.
  std::vector<Eigen::Vector3f> positions;
  /// A point: 1 where it counts, 0 where there is nothing to model (its rows are zero); empty: all
  /// points count.
  std::vector<uint8_t> mask;
  FunctionRows functions;
  /// A column each, unit, world frame (of a view grid: the vertex frame). Of a cube: the texel's
  /// middle.
  std::vector<Eigen::Vector3d> directions;

  int64_t RowOf(int64_t point, int channel) const { return channel * points + point; }
};

}  // namespace lfm
