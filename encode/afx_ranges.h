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

/// One range for surface and view maps alike, as AFX has it, and how each term's maps are scaled
/// before they are quantised with it: u' = surface_scale u, v' = v / surface_scale. A negative one
/// turns both signs.
struct SharedRange {
  MapRange range;
  std::vector<double> surface_scales;  ///< one a vertex
};

/// Chooses the range of one term of all vertices that have it. The two maps of a term can take any
/// share of its strength; a vertex needs a range of at least R = sqrt(max|u| max|v|). Signs are
/// chosen so that the larger values are positive. Within the range a vertex takes the share with
/// the least expected error of its product.
SharedRange ShareRange(std::span<const TermExtents> terms);

}  // namespace lfm
