// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/voxel_grid.h"

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

constexpr int kBitsPerAxis = 21;

uint64_t Key(const Eigen::Vector3i& cell) {
  return (static_cast<uint64_t>(cell.x()) << (2 * kBitsPerAxis)) |
         (static_cast<uint64_t>(cell.y()) << kBitsPerAxis) | static_cast<uint64_t>(cell.z());
}

Eigen::Vector3i NeighborOffset(int i) { return {i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1}; }

}  // namespace

Eigen::Vector3i VoxelGrid::CellOf(const Eigen::Vector3d& point) const {
  return ((point - origin) / size_mm).array().floor().cast<int>();
}

int VoxelGrid::Find(const Eigen::Vector3i& cell) const {
  if (cell.minCoeff() < 0 || cell.maxCoeff() >= (1 << kBitsPerAxis)) return -1;
  const uint64_t key = Key(cell);
  const auto found =
      std::lower_bound(cells.begin(), cells.end(), key,
                       [](const Eigen::Vector3i& c, uint64_t k) { return Key(c) < k; });
  return found != cells.end() && *found == cell ? static_cast<int>(found - cells.begin()) : -1;
}

VoxelGrid MakeVoxelGrid(const std::vector<Eigen::Vector3d>& points, double size_mm) {
  VoxelGrid grid;
  grid.size_mm = size_mm;
  grid.offsets = {0};
  if (points.empty()) return grid;
  Eigen::Vector3d low = points.front(), high = points.front();
  for (const Eigen::Vector3d& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  if (!((high - low).maxCoeff() / size_mm < (1 << kBitsPerAxis) - 4)) {
    throw Error("point cloud: the points lie too far apart to be one object; check the scans");
  }
  grid.origin = low;
  std::vector<std::pair<uint64_t, int>> order(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    order[i] = {Key(grid.CellOf(points[i])), static_cast<int>(i)};
  }
  std::sort(order.begin(), order.end());
  grid.points.reserve(points.size());
  for (size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || order[i].first != order[i - 1].first) {
      grid.cells.push_back(grid.CellOf(points[order[i].second]));
      if (i > 0) grid.offsets.push_back(static_cast<int64_t>(i));
    }
    grid.points.push_back(order[i].second);
  }
  grid.offsets.push_back(static_cast<int64_t>(order.size()));
  return grid;
}

std::vector<int64_t> CountNeighborhoods(const VoxelGrid& grid) {
  std::vector<int64_t> counts(grid.cells.size());
  ParallelFor(
      0, static_cast<int64_t>(grid.cells.size()),
      [&](int64_t v) {
        for (int i = 0; i < 27; ++i) {
          const int neighbor = grid.Find(grid.cells[v] + NeighborOffset(i));
          if (neighbor >= 0) counts[v] += grid.Count(neighbor);
        }
      },
      1024);
  return counts;
}

std::vector<int> LabelPieces(const VoxelGrid& grid) {
  std::vector<int> labels(grid.cells.size(), -1);
  int label = 0;
  std::vector<int> open;
  for (size_t seed = 0; seed < labels.size(); ++seed) {
    if (labels[seed] >= 0) continue;
    labels[seed] = label;
    open.push_back(static_cast<int>(seed));
    while (!open.empty()) {
      const int voxel = open.back();
      open.pop_back();
      for (int i = 0; i < 27; ++i) {
        const int neighbor = grid.Find(grid.cells[voxel] + NeighborOffset(i));
        if (neighbor < 0 || labels[neighbor] >= 0) continue;
        labels[neighbor] = label;
        open.push_back(neighbor);
      }
    }
    ++label;
  }
  return labels;
}

}  // namespace lfm
