// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "encode/map_quantization.h"

namespace lfm {

/// What the range of a light map needs to know of one vertex's term u v^T: the values that its maps
/// take, and their squared norms.
struct TermExtents {
  Extent surface, view;
  double surface_norm2 = 0, view_norm2 = 0;
  int surface_samples = 0, view_samples = 0;
};

/// How a term's maps are scaled before they are quantised with their light map's range:
/// u' = surface u, v' = v / surface. A negative `surface` turns both signs.
struct SharedScale {
  int light_map = 0;
  double surface = 1;
};

/// One range a light map, for surface and view maps alike, as AFX has it.
struct SharedRanges {
  std::vector<MapRange> ranges;     ///< one a light map, the widest first
  std::vector<SharedScale> scales;  ///< one a vertex
};

/// Chooses ranges for one term of all vertices that have it. The two maps of a term can take any
/// share of its strength; a vertex needs a range of at least R = sqrt(max|u| max|v|). Vertices are
/// split by R into at most `light_maps` groups such that the expected squared error of all products
/// is least, and signs are chosen so that the larger values are positive. Within its group's range
/// a vertex takes the share with the least expected error of its product.
SharedRanges ShareRanges(std::span<const TermExtents> terms, int light_maps);

}  // namespace lfm
