// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "sample_data/shapes/shape.h"

namespace lfm {

/// One leaf of a plant. It starts at `base`, leaves along `direction` and bends down under its
/// weight; `up` is roughly its upper side.
struct Leaf {
  Eigen::Vector3d base = {0, 0, 0}, direction = {1, 0, 0}, up = {0, 0, 1};
  double length_mm = 40, width_mm = 16;
  double droop = 0.6;  ///< angle by which its tip has bent down, rad
  double curl = 0.3;   ///< how far its halves fold up along the middle, rad
};

/// Leaves as thin closed bodies (`thickness_mm`), pointed ovals with a fold along the middle and a
/// waved edge; `segments` along each. uv runs along (u) and across (v).
Shape MakeLeaves(const std::vector<Leaf>& leaves, double thickness_mm, int segments);

/// A tube round a polyline of `points` whose radius goes from `start_radius` to `end_radius`,
/// closed by flat ends; `sides` round it. Throws Error for fewer than two points.
Shape MakeTube(const std::vector<Eigen::Vector3d>& points, double start_radius, double end_radius,
               int sides);

enum class PlantPart { kLeaves, kStems };

/// A pot plant of many thin leaves, without its pot: stems rise from a disc of radius 12 mm in
/// z = 0, `leaf_count` leaves stand round them in golden-angle turns, larger below.
struct PlantSizes {
  int stem_count = 5, leaf_count = 90;
  double height_mm = 130;
  double leaf_length_mm = 34, leaf_width_mm = 13;
};
Shape MakePlant(PlantPart part, const PlantSizes& sizes, uint64_t seed, double edge_mm);

/// A tree: a trunk that forks `levels` times, and leaves at the ends of its twigs.
struct TreeSizes {
  int levels = 6, leaves_per_twig = 7;
  double height_mm = 150, trunk_radius_mm = 5;
  double leaf_length_mm = 9, leaf_width_mm = 5;
};
Shape MakeTree(PlantPart part, const TreeSizes& sizes, uint64_t seed, double edge_mm);

}  // namespace lfm
