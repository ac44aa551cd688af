// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/triangle_mesh.h"

namespace lfm {

/// How directions above a vertex are laid out on the square [0, 1]^2 of a view map.
enum class DirectionMap {
  kHemiOctahedral,  ///< default: corner-aligned texels, even at grazing angles (FINDINGS 5)
  kOrthographic,    ///< the paper's disc: x = (d.x + 1) / 2, y = (d.y + 1) / 2 (Equation 7)
};

/// Maps a unit direction in a vertex frame (z along the normal) to the square. Directions below
/// the horizon are first moved onto it (z = 0, same azimuth); (0, 0, -1) goes to the centre.
Eigen::Vector2d SquareFromDirection(DirectionMap map, const Eigen::Vector3d& direction_in_frame);
/// The inverse, unit, z >= 0. Points outside the orthographic disc are moved to its rim.
Eigen::Vector3d DirectionFromSquare(DirectionMap map, const Eigen::Vector2d& square);

/// Direction of view-grid entry q = y * grid + x: square position (x, y) / (grid - 1)
/// (corner-aligned texels).
Eigen::Vector3d GridDirection(DirectionMap map, int grid, int q);

/// Vertex frames: columns x, y, z, right-handed and orthonormal, z the vertex normal; x is the
/// projection of the direction to the first neighbour in the ring (the MPEG-4 appendix's rule, with
/// its errata repaired: y = z x x, normalised, and a fallback axis when the edge is parallel to z).
std::vector<Eigen::Matrix3d> ComputeVertexFrames(const TriangleMesh& mesh);

}  // namespace lfm
