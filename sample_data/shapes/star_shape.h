// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sample_data/shapes/shape.h"

namespace lfm {

/// Sizes of a faceted star that stands upright in the plane y = 0, one arm up, round the origin.
struct StarSizes {
  int arms = 5;
  double tip_mm = 50;         ///< from the centre to a tip
  double notch_mm = 22;       ///< from the centre to a notch between arms
  double half_depth_mm = 15;  ///< at the centre, in y
  double half_rim_mm = 3.5;   ///< at the rim
  double bevel_mm = 1.2;      ///< blend between facet and rim; ridges are rounded alike
};

/// A solid star of two facets an arm and side, joined by a rim: closed, facets flat to rounding.
/// Throws Error unless 3 <= arms <= 12, 0 < notch < tip and 0 < rim < depth.
Shape MakeStar(const StarSizes& sizes, double edge_mm);

}  // namespace lfm
