// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/consolidation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "mesh/nearest_points.h"
#include "mesh/point_selection.h"
#include "mesh/voxel_grid.h"

namespace lfm {
namespace {

struct WeightedPoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
  double weight = 0, count = 0;
};

void Append(const WeightedPoint& sum, PointCloud& cloud) {
  const double length = sum.normal.norm();
  if (!(length > 1e-6 * sum.weight)) return;
  cloud.points.push_back(sum.point / sum.weight);
  cloud.normals.push_back(sum.normal / length);
  cloud.confidence.push_back(static_cast<float>(sum.weight / sum.count));
}

PointCloud AverageInVoxels(const PointCloud& points, double voxel_mm) {
  const VoxelGrid grid = MakeVoxelGrid(points.points, voxel_mm);
  PointCloud averaged;
  for (size_t v = 0; v < grid.cells.size(); ++v) {
    const Eigen::Vector3d& facing = points.normals[grid.points[grid.offsets[v]]];
    WeightedPoint front, back;
    for (int64_t k = grid.offsets[v]; k < grid.offsets[v + 1]; ++k) {
      const int i = grid.points[k];
      WeightedPoint& side = points.normals[i].dot(facing) > 0 ? front : back;
      const double weight = points.confidence[i];
      side.point += weight * points.points[i];
      side.normal += weight * points.normals[i];
      side.weight += weight;
      side.count += 1;
    }
    Append(front, averaged);
    Append(back, averaged);
  }
  return averaged;
}

constexpr int kNeighbors = 16;

struct PlaneFit {
  double distance = 0;  ///< of the point from the plane through its neighbours
  std::array<int, kNeighbors> neighbors;
};

std::vector<PlaneFit> MeasureOffsets(const PointCloud& cloud) {
  const NearestPoints index(cloud.points);
  std::vector<PlaneFit> fits(cloud.points.size());
  ParallelFor(
      0, static_cast<int64_t>(fits.size()),
      [&](int64_t i) {
        Eigen::Vector3d center = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
        fits[i].neighbors.fill(static_cast<int>(i));
        int used = 0;
        // One more than needed: the nearest point is the point itself.
        for (const NearPoint& near : index.Find(cloud.points[i], kNeighbors + 1)) {
          if (near.index == i || used == kNeighbors) continue;
          if (cloud.normals[near.index].dot(cloud.normals[i]) < 0) continue;
          center += cloud.points[near.index];
          normal += cloud.normals[near.index];
          fits[i].neighbors[used++] = near.index;
        }
        if (used == 0 || !(normal.norm() > 1e-6)) return;
        fits[i].distance = std::abs(normal.normalized().dot(cloud.points[i] - center / used));
      },
      256);
  return fits;
}

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

}  // namespace

PointCloud ConsolidatePoints(const PointCloud& points, double voxel_mm) {
  if (points.points.empty()) return points;
  const PointCloud averaged = AverageInVoxels(points, voxel_mm);
  if (averaged.points.empty()) return averaged;
  const std::vector<PlaneFit> fits = MeasureOffsets(averaged);
  std::vector<double> distances(fits.size());
  for (size_t i = 0; i < fits.size(); ++i) distances[i] = fits[i].distance;
  const double usual = Median(distances);
  std::vector<char> keep(fits.size());
  ParallelFor(
      0, static_cast<int64_t>(fits.size()),
      [&](int64_t i) {
        std::vector<double> around(kNeighbors);
        for (int k = 0; k < kNeighbors; ++k) around[k] = distances[fits[i].neighbors[k]];
        // 1.5 median: the standard deviation of a normal distribution.
        keep[i] = distances[i] <= 5 * 1.5 * std::max(usual, Median(std::move(around)));
      },
      256);
  return SelectPoints(averaged, keep);
}

}  // namespace lfm
