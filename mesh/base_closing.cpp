// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/base_closing.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/parallel.h"
#include "mesh/voxel_grid.h"

namespace lfm {
namespace {

constexpr double kDepthInSpacings = 6;
constexpr double kBandInSpacings = 12;
constexpr double kSidewaysInSpacings = 4;
constexpr double kFacingUp = 0.7;     // cosine: a shelf, not a wall that goes down
constexpr double kFacingDown = 0.97;  // cosine: has no direction of its own downwards

struct WallPoint {
  Eigen::Vector3d point, normal;
};

// The direction downwards along the surface, at most 45 degrees off the vertical.
Eigen::Vector3d Downwards(const Eigen::Vector3d& normal) {
  Eigen::Vector3d down = -Eigen::Vector3d::UnitZ() + normal.z() * normal;
  const double sideways = down.head<2>().norm();
  if (sideways > -down.z()) down.head<2>() *= -down.z() / sideways;
  return down.normalized();
}

std::vector<WallPoint> AverageLowBand(const PointCloud& object, double spacing_mm) {
  std::vector<double> heights(object.points.size());
  for (size_t i = 0; i < heights.size(); ++i) heights[i] = object.points[i].z();
  const size_t low = std::min<size_t>(20, heights.size() - 1);
  std::nth_element(heights.begin(), heights.begin() + low, heights.end());
  const double top = heights[low] + kBandInSpacings * spacing_mm;

  PointCloud band;
  for (size_t i = 0; i < object.points.size(); ++i) {
    if (object.points[i].z() > top) continue;
    band.points.push_back(object.points[i]);
    band.normals.push_back(object.normals[i]);
  }
  const VoxelGrid grid = MakeVoxelGrid(band.points, 1.5 * spacing_mm);
  std::vector<WallPoint> averaged;
  for (size_t v = 0; v < grid.cells.size(); ++v) {
    Eigen::Vector3d point = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
    for (int64_t k = grid.offsets[v]; k < grid.offsets[v + 1]; ++k) {
      point += band.points[grid.points[k]];
      normal += band.normals[grid.points[k]];
    }
    if (!(normal.norm() > 1e-6)) continue;
    averaged.push_back(
        {point / static_cast<double>(grid.Count(static_cast<int>(v))), normal.normalized()});
  }
  return averaged;
}

// Those below which the surface does not go on.
std::vector<WallPoint> FindLowestRing(const std::vector<WallPoint>& band, double spacing_mm) {
  std::vector<Eigen::Vector3d> points;
  for (const WallPoint& p : band) points.push_back(p.point);
  const double reach = 4.5 * spacing_mm;
  const VoxelGrid grid = MakeVoxelGrid(points, reach);
  std::vector<WallPoint> ring;
  for (const WallPoint& p : band) {
    if (p.normal.z() > kFacingUp || p.normal.z() < -kFacingDown) continue;
    const Eigen::Vector3d down = Downwards(p.normal);
    bool goes_on = false;
    for (int i = 0; i < 27 && !goes_on; ++i) {
      const Eigen::Vector3i offset(i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1);
      const int voxel = grid.Find(grid.CellOf(p.point) + offset);
      if (voxel < 0) continue;
      for (int64_t k = grid.offsets[voxel]; k < grid.offsets[voxel + 1]; ++k) {
        const Eigen::Vector3d step = points[grid.points[k]] - p.point;
        goes_on |= step.norm() < reach && step.dot(down) > 0.75 * spacing_mm &&
                   step.dot(down) > 0.6 * step.norm();
      }
    }
    if (!goes_on) ring.push_back(p);
  }
  return ring;
}

// Walls from the ring to `floor_z`, and where each of them ends.
struct Walls {
  PointCloud points;
  std::vector<WallPoint> feet;
};

Walls ContinueWalls(const std::vector<WallPoint>& ring, double spacing_mm, double floor_z) {
  Walls walls;
  const double step = spacing_mm;
  for (const WallPoint& start : ring) {
    Eigen::Vector3d point = start.point;
    Eigen::Vector3d down = Downwards(start.normal);
    double sideways = 0;
    while (point.z() > floor_z) {
      if (sideways > kSidewaysInSpacings * spacing_mm) down = -Eigen::Vector3d::UnitZ();
      point += step * down;
      sideways += step * down.head<2>().norm();
      const Eigen::Vector3d normal = (start.normal - start.normal.dot(down) * down).normalized();
      walls.points.points.push_back(point);
      walls.points.normals.push_back(normal);
    }
    Eigen::Vector3d outwards(start.normal.x(), start.normal.y(), 0);
    walls.feet.push_back({point, outwards.normalized()});
  }
  return walls;
}

// The length of contour that each foot stands for: one over the density of feet along it, by a
// Gaussian window.
std::vector<double> ContourLengths(const std::vector<WallPoint>& feet, double window_mm) {
  std::vector<double> lengths(feet.size());
  ParallelFor(
      0, static_cast<int64_t>(feet.size()),
      [&](int64_t i) {
        double density = 0;
        for (const WallPoint& other : feet) {
          const double square = (feet[i].point - other.point).head<2>().squaredNorm();
          density += std::exp(-square / (2 * window_mm * window_mm));
        }
        lengths[i] = window_mm * std::sqrt(2 * std::numbers::pi) / density;
      },
      16);
  return lengths;
}

double WindingNumber(const Eigen::Vector2d& x, const std::vector<WallPoint>& feet,
                     const std::vector<double>& lengths, double nearest_mm) {
  double sum = 0;
  for (size_t i = 0; i < feet.size(); ++i) {
    const Eigen::Vector2d to_foot = feet[i].point.head<2>() - x;
    const double square = std::max(to_foot.squaredNorm(), nearest_mm * nearest_mm);
    sum += lengths[i] * feet[i].normal.head<2>().dot(to_foot) / square;
  }
  return sum / (2 * std::numbers::pi);
}

std::vector<Eigen::Vector3d> LayFloor(const std::vector<WallPoint>& feet, double spacing_mm,
                                      double floor_z) {
  const std::vector<double> lengths = ContourLengths(feet, 3 * spacing_mm);
  Eigen::Vector2d low = feet.front().point.head<2>(), high = low;
  for (const WallPoint& foot : feet) {
    low = low.cwiseMin(foot.point.head<2>());
    high = high.cwiseMax(foot.point.head<2>());
  }
  const double step = 1.5 * spacing_mm;
  const int64_t columns = static_cast<int64_t>((high - low).x() / step) + 1;
  const int64_t rows = static_cast<int64_t>((high - low).y() / step) + 1;
  std::vector<std::vector<Eigen::Vector3d>> floor_rows(rows);
  ParallelFor(0, rows, [&](int64_t row) {
    for (int64_t column = 0; column < columns; ++column) {
      const Eigen::Vector2d x = low + step * Eigen::Vector2d(column, row);
      if (WindingNumber(x, feet, lengths, spacing_mm) > 0.5) {
        floor_rows[row].emplace_back(x.x(), x.y(), floor_z);
      }
    }
  });
  std::vector<Eigen::Vector3d> floor;
  for (const auto& row : floor_rows) floor.insert(floor.end(), row.begin(), row.end());
  return floor;
}

}  // namespace

PointCloud ContinueBelowPlatform(const PointCloud& object, double spacing_mm) {
  PointCloud added;
  if (object.points.empty()) return added;
  const std::vector<WallPoint> ring =
      FindLowestRing(AverageLowBand(object, spacing_mm), spacing_mm);
  if (ring.empty()) return added;
  const double floor_z = -kDepthInSpacings * spacing_mm;
  Walls walls = ContinueWalls(ring, spacing_mm, floor_z);
  added = std::move(walls.points);
  for (const Eigen::Vector3d& p : LayFloor(walls.feet, spacing_mm, floor_z)) {
    added.points.push_back(p);
    added.normals.push_back(-Eigen::Vector3d::UnitZ());
  }
  added.confidence.assign(added.points.size(), 0);
  return added;
}

}  // namespace lfm
