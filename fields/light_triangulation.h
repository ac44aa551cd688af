// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace lfm {

/// The lights' directions as the corners of triangles on the sphere: the Delaunay triangulation,
/// which is the convex hull. Facets that close the gap of a dome are left out: those whose
/// circumscribed cap has a radius of more than 30 degrees and of three times the median.
struct LightTriangulation {
  std::vector<Eigen::Vector3d> directions;
  std::vector<Eigen::Vector3i> triangles;
  std::vector<double> cap_radius;    ///< a triangle, radians
  std::vector<Eigen::Vector2i> rim;  ///< edges with a triangle on one side only, or none
  double median_radius = 0;          ///< of the caps, radians; without triangles see below

  /// Whether there is light all round.
  bool Surrounds() const { return rim.empty(); }
};

/// Lights that coincide count once, the first of them. Three and more on a great circle are a ring
/// of rim edges without triangles, two are one edge, one an edge to itself; then `median_radius` is
/// the median length of the edges, or a right angle. Throws Error without directions, or when one
/// is not of unit length.
LightTriangulation TriangulateLights(const std::vector<Eigen::Vector3d>& directions);

/// Shares of up to three lights, not negative, that sum to 1; unused ones are 0 of light 0.
struct LightShares {
  std::array<int, 3> light = {0, 0, 0};
  std::array<double, 3> share = {0, 0, 0};
};

/// Barycentric shares of `direction` (any length but 0) in the triangle that it passes through,
/// where it meets the triangle's plane; outside all of them those of the nearest point of the rim.
/// Continuous as the direction moves, except far outside where two places of the rim are equally
/// near; exact at the lights.
LightShares InterpolateLights(const LightTriangulation& lights, const Eigen::Vector3d& direction);

}  // namespace lfm
