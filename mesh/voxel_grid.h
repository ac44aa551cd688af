// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace lfm {

/// Points sorted into the cubes of a regular grid; only cubes that hold points exist.
///
/// Cubes are ordered by (x, y, z) cell, points within a cube by index.
struct VoxelGrid {
  double size_mm = 0;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3i> cells;  ///< of every occupied cube
  std::vector<int64_t> offsets;        ///< points of cube v: points[offsets[v] .. offsets[v + 1])
  std::vector<int> points;

  int64_t Count(int voxel) const { return offsets[voxel + 1] - offsets[voxel]; }
  /// The cube at a cell, or -1.
  int Find(const Eigen::Vector3i& cell) const;
  Eigen::Vector3i CellOf(const Eigen::Vector3d& point) const;
};

/// Makes the grid. Throws Error when the points' extent is more than two million cubes.
VoxelGrid MakeVoxelGrid(const std::vector<Eigen::Vector3d>& points, double size_mm);

/// The points of each cube and of its 26 neighbours together.
std::vector<int64_t> CountNeighborhoods(const VoxelGrid& grid);

/// Pieces of the grid that hang together over faces, edges or corners: a label a cube, from 0 in
/// order of the first cube.
std::vector<int> LabelPieces(const VoxelGrid& grid);

}  // namespace lfm
