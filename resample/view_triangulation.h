// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

namespace lfm {

/// The Delaunay triangulation of view directions laid out in a plane (Chen 2002, section 5.2,
/// Figure 7, centre). View numbers are indices into the points that were given.
struct ViewTriangulation {
  struct Face {
    std::array<int, 3> views;      ///< counter-clockwise
    std::array<int, 3> neighbors;  ///< across the edge opposite to views[k]; -1 at the hull
  };
  std::vector<Face> faces;  ///< none when all points lie on one line
  /// Edges of the convex hull; of points on one line, the segments between successive ones. Empty
  /// with fewer than two different points.
  std::vector<std::array<int, 2>> hull;
  /// One view for every different point: of points that coincide exactly, the first given.
  std::vector<int> distinct;
};

/// Triangulates with exact predicates: right for collinear, cocircular and repeated points, and for
/// none, one or two. The result does not depend on anything but the points. Throws Error when a
/// coordinate is not finite.
ViewTriangulation TriangulateViews(std::span<const Eigen::Vector2d> points);

}  // namespace lfm
