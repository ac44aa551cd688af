// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/triangle_mesh.h"

namespace lfm {

/// How directions above a vertex are laid out on the square [0, 1]^2 of a view map.
enum class DirectionMap {
  /// Default: corner-aligned texels, even at grazing angles. With
  /// p = (d.x, d.y) / (|d.x| + |d.y| + d.z): x = (p.x + p.y + 1) / 2, y = (p.x - p.y + 1) / 2
  /// (Cigolle et al. 2014, "A Survey of Efficient Representations for Independent Unit Vectors").
  kHemiOctahedral,
  kOrthographic,  ///< the paper's disc: x = (d.x + 1) / 2, y = (d.y + 1) / 2 (Equation 7)
  /// The same with a skirt. Triangles are seen from below their vertices' horizons where
  /// the surface is curved, so that maps reach down to z = -kSkirt:
  /// p = (d.x, d.y) / (|d.x| + |d.y| + (d.z + kSkirt) / (1 + kSkirt)). In the middle texels lie as
  /// close as without.
  kHemiOctahedralSkirt,
};

/// How far below the horizon the border of kHemiOctahedralSkirt lies: 20.5 degrees.
inline constexpr double kSkirt = 0.35;

/// Maps a unit direction in a vertex frame (z along the normal) to the square. Directions below
/// the horizon (with a skirt: below its border) are first moved onto it along their meridian;
/// (0, 0, -1) goes to the centre, and so do the zero vector and anything that is not finite.
Eigen::Vector2d SquareFromDirection(DirectionMap map, const Eigen::Vector3d& direction_in_frame);
/// The inverse, unit, z >= 0 (with a skirt: z >= -kSkirt). Points outside the orthographic disc are
/// moved to its rim; points outside the square to its border; a point that is not finite to the
/// centre.
Eigen::Vector3d DirectionFromSquare(DirectionMap map, const Eigen::Vector2d& square);

/// Direction of view-grid entry q = y * grid + x: square position (x, y) / (grid - 1)
/// (corner-aligned texels). grid >= 2.
Eigen::Vector3d GridDirection(DirectionMap map, int grid, int q);

/// Vertex frames: columns x, y, z, right-handed and orthonormal, z the vertex normal; x is the
/// projection of the direction to the first neighbour in the ring (the MPEG-4 appendix's rule, with
/// its errata repaired: y = z x x, normalised, and a fallback axis when the edge is parallel to z).
///
/// The first neighbour is the corner after the vertex in the first triangle that holds it. The
/// normal is the mesh's own where it has one of non-zero length, else the area-weighted one; the
/// fallback is the world axis least along z, which also serves a vertex of no triangle.
std::vector<Eigen::Matrix3d> ComputeVertexFrames(const TriangleMesh& mesh);

}  // namespace lfm
