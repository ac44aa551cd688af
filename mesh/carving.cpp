// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/carving.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "core/ray_scene.h"
#include "mesh/nearest_points.h"

namespace lfm {
namespace {

constexpr int kMostCells = 512;  // along a side
constexpr int kNormalReach = 2;

enum Content : uint8_t { kOutside, kSolid, kFree };

struct CellGrid {
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
  double cell_mm = 0;
  Eigen::Vector3i size = Eigen::Vector3i::Zero();
  std::vector<uint8_t> content;

  Eigen::Vector3d Middle(const Eigen::Vector3i& c) const {
    return low + cell_mm * (c.cast<double>() + Eigen::Vector3d::Constant(0.5));
  }
  size_t Index(const Eigen::Vector3i& c) const {
    return (static_cast<size_t>(c.z()) * size.y() + c.y()) * size.x() + c.x();
  }
  Content At(const Eigen::Vector3i& c) const {
    if ((c.array() < 0).any() || (c.array() >= size.array()).any()) return kOutside;
    return static_cast<Content>(content[Index(c)]);
  }
};

// Which cells of a column along x lie inside: rays cross the surface in and out.
void FillRow(const RayScene& scene, const FreeSpace& free, CellGrid& grid, int y, int z) {
  const Eigen::Vector3d start = grid.Middle({0, y, z}) - Eigen::Vector3d(2 * grid.cell_mm, 0, 0);
  std::vector<double> crossings;
  const double step = 1e-6 * grid.cell_mm * grid.size.x();
  double from = 0;
  while (const auto hit = scene.Intersect(start, Eigen::Vector3d::UnitX(), from)) {
    crossings.push_back(hit->distance);
    from = hit->distance + step;
  }
  if (crossings.size() % 2 != 0) return;  // grazes an edge: claim nothing
  for (size_t k = 0; k + 1 < crossings.size(); k += 2) {
    const auto first = static_cast<int>(std::ceil(crossings[k] / grid.cell_mm - 2));
    const auto last = static_cast<int>(std::floor(crossings[k + 1] / grid.cell_mm - 2));
    for (int x = std::max(first, 0); x <= std::min(last, grid.size.x() - 1); ++x) {
      const Eigen::Vector3i c(x, y, z);
      grid.content[grid.Index(c)] = free.IsFree(grid.Middle(c)) ? kFree : kSolid;
    }
  }
}

CellGrid MakeGrid(const TriangleMesh& solid, const FreeSpace& free, double cell_mm) {
  CellGrid grid;
  Eigen::Vector3d low = solid.vertices.front(), high = low;
  for (const Eigen::Vector3d& v : solid.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  grid.cell_mm = std::max(cell_mm, (high - low).maxCoeff() / kMostCells);
  grid.low = low;
  grid.size = ((high - low) / grid.cell_mm).cast<int>() + Eigen::Vector3i::Ones();
  grid.content.assign(static_cast<size_t>(grid.size.x()) * grid.size.y() * grid.size.z(), kOutside);
  const RayScene scene(solid);
  ParallelFor(0, static_cast<int64_t>(grid.size.y()) * grid.size.z(), [&](int64_t row) {
    FillRow(scene, free, grid, static_cast<int>(row % grid.size.y()),
            static_cast<int>(row / grid.size.y()));
  });
  return grid;
}

// Towards the free cells round a place, away from the solid ones.
Eigen::Vector3d FreeDirection(const CellGrid& grid, const Eigen::Vector3i& cell) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int z = -kNormalReach; z <= kNormalReach; ++z) {
    for (int y = -kNormalReach; y <= kNormalReach; ++y) {
      for (int x = -kNormalReach; x <= kNormalReach; ++x) {
        const Eigen::Vector3i offset(x, y, z);
        const Content content = grid.At(cell + offset);
        if (content == kSolid) sum -= offset.cast<double>();
        if (content == kFree) sum += offset.cast<double>();
      }
    }
  }
  return sum;
}

}  // namespace

PointCloud FindCarvedBorder(const TriangleMesh& solid, const FreeSpace& free,
                            const PointCloud& measured, double cell_mm, double clearance_mm) {
  PointCloud border;
  if (free.Empty() || solid.triangles.empty()) return border;
  if (!(cell_mm > 0)) throw Error("carving: the cell size must be positive");
  const CellGrid grid = MakeGrid(solid, free, cell_mm);
  const NearestPoints index(measured.points);
  for (int z = 0; z < grid.size.z(); ++z) {
    for (int y = 0; y < grid.size.y(); ++y) {
      for (int x = 0; x < grid.size.x(); ++x) {
        const Eigen::Vector3i cell(x, y, z);
        if (grid.At(cell) != kSolid) continue;
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        int faces = 0;
        for (int side = 0; side < 6; ++side) {
          Eigen::Vector3i step = Eigen::Vector3i::Zero();
          step[side / 2] = side % 2 == 0 ? -1 : 1;
          if (grid.At(cell + step) != kFree) continue;
          sum += 0.5 * step.cast<double>();
          ++faces;
        }
        if (faces == 0) continue;
        const Eigen::Vector3d point = grid.Middle(cell) + grid.cell_mm * sum / faces;
        const Eigen::Vector3d normal = FreeDirection(grid, cell);
        if (point.z() < clearance_mm || !(normal.norm() > 0)) continue;
        const auto nearest = index.Find(point, 1);
        if (!nearest.empty() && nearest.front().distance < clearance_mm) continue;
        border.points.push_back(point);
        border.normals.push_back(normal.normalized());
        border.confidence.push_back(0);
      }
    }
  }
  return border;
}

}  // namespace lfm
