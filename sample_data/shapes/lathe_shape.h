// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sample_data/shapes/shape.h"

namespace lfm {

/// Grooves along a turned body, as on a column.
struct Flutes {
  int count = 0;
  double depth_mm = 0;
  double low_mm = 0, high_mm = 0;  ///< they reach from this z to that one
};

/// A turned body: `profile` holds points (radius, z) in mm from the axis below, up the outside (and
/// down an inside), back to the axis; the solid lies to the left. Corners are rounded by arcs of
/// `rounding_mm` (less where segments are short), edges are about `edge_mm` long. Closed. Throws
/// Error unless the profile has three points or more, ends on the axis at both ends, and has
/// positive radii between.
Shape MakeLathe(const std::vector<Eigen::Vector2d>& profile, double rounding_mm, double edge_mm,
                const Flutes& flutes = {});

}  // namespace lfm
