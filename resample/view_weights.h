// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "resample/direction_map.h"
#include "resample/light_field.h"

namespace lfm {

/// Where a direction lies in the plane in which views are triangulated.
///
/// Hemi-octahedral maps, with a skirt or without, use the stereographic projection (d.x, d.y) / (1
/// + d.z): circles stay circles, so the triangulation is the Delaunay triangulation of the sphere;
/// the hemisphere is the unit disc, and directions below the horizon keep their place outside it
/// (at most at radius 1e3, where (0, 0, -1) is put too). Orthographic maps use the paper's (d.x,
/// d.y); directions below the horizon, which would fold onto those above, are unfolded to radius 2
/// - |(d.x, d.y)|. Continuous in the direction but at (0, 0, -1). The direction must be unit and
/// finite.
Eigen::Vector2d PlaneFromDirection(DirectionMap map, const Eigen::Vector3d& direction_in_frame);

/// PlaneFromDirection of every entry of a view grid, in order: grid^2 points.
std::vector<Eigen::Vector2d> GridInPlane(DirectionMap map, int grid);

/// Delaunay view weights (Chen 2002, section 5.2, Figure 7): for every query point three views and
/// barycentric weights, as ViewWeights of light_field.h holds them.
///
/// Inside the convex hull of `views` the weights reproduce every linear function of the plane.
/// Outside, and for views on one line, they are those of the nearest point of the hull (two views
/// at most) and `seen` is 0, but for queries that lie on the hull within 1e-9. No views: all three
/// arrays are empty. One view: its weight is one. Of views that coincide exactly the first is
/// used. With a `hull_margin` in (0, 1) the weights are those of the nearest point of the hull
/// drawn in by it (view_hull.h), for queries outside the hull and for those inside near it; `seen`
/// does not change. Weights are >= 0 and sum to one within float rounding. At most 65535 views;
/// throws Error for more, and when a coordinate is not finite.
LightField::WeightBuffer ComputeViewWeights(std::span<const Eigen::Vector2d> views,
                                            std::span<const Eigen::Vector2d> queries,
                                            double hull_margin = 0);

}  // namespace lfm
