// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/cleaning.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "mesh/point_selection.h"
#include "mesh/voxel_grid.h"

namespace lfm {
namespace {

constexpr int kFewestPoints = 100;
constexpr double kSmallestPiece = 0.03;
// What faces sideways is not the platform: a third of the margin is enough.
constexpr double kWallCosine = 0.5, kWallMargin = 1.0 / 3;
// Standard deviation across a plane, relative to the extent along it, below which a cloud is flat:
// a scan's noise over an object's size is ten times less, a sheet of cardboard ten times more.
constexpr double kFlat = 0.003;
// No object of so few millimetres can be scanned; in metres, few are larger.
constexpr double kLargestInMetres = 2;

void CheckCloud(const PointCloud& cloud, const std::string& where) {
  const size_t n = cloud.points.size();
  if (n == 0) {
    throw Error(where + ": it is empty; check that the scans decode");
  }
  if (cloud.normals.size() != n || (!cloud.confidence.empty() && cloud.confidence.size() != n)) {
    throw Error(where + ": every point needs a normal (and a confidence, if any has one)");
  }
  for (size_t i = 0; i < n; ++i) {
    if (!cloud.points[i].allFinite() || !cloud.normals[i].allFinite() ||
        (!cloud.confidence.empty() && !std::isfinite(cloud.confidence[i]))) {
      throw Error(where + ": point " + std::to_string(i) + " is not finite; check the scans");
    }
  }
  if (n > 1 && std::all_of(cloud.points.begin(), cloud.points.end(),
                           [&](const Eigen::Vector3d& p) { return p == cloud.points[0]; })) {
    throw Error(where + ": all " + std::to_string(n) +
                " points are the same; check the scans, or write the cloud again");
  }
}

// Coordinates that one wild point cannot move.
struct RobustBox {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double extent = 0;
};

RobustBox MeasureBox(const std::vector<Eigen::Vector3d>& points) {
  RobustBox box;
  std::vector<double> values(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (size_t i = 0; i < points.size(); ++i) values[i] = points[i][axis];
    std::sort(values.begin(), values.end());
    const size_t n = values.size();
    box.center[axis] = values[n / 2];
    box.extent = std::max(box.extent, values[n - 1 - n / 50] - values[n / 50]);
  }
  return box;
}

void CheckUnit(const PointCloud& cloud, const CleaningLimits& limits, const std::string& where) {
  const bool all_low =
      std::all_of(cloud.points.begin(), cloud.points.end(),
                  [&](const Eigen::Vector3d& p) { return p.z() < limits.platform_margin_mm; });
  if (!all_low) return;
  const double extent = MeasureBox(cloud.points).extent;
  if (!(extent > 0 && extent <= kLargestInMetres)) return;
  std::ostringstream message;
  message << where << ": all " << cloud.points.size() << " points lie below "
          << limits.platform_margin_mm << " mm and within " << extent
          << " mm: the cloud looks to be in metres; multiply its coordinates by 1000";
  throw Error(message.str());
}

void CheckCount(const PointCloud& cloud, const std::string& where) {
  const size_t n = cloud.points.size();
  if (n < kFewestPoints) {
    throw Error(where + ": only " + std::to_string(n) +
                " points lie on the object, too few for a surface; check the scans and "
                "--platform-margin-mm");
  }
}

void CheckShape(const PointCloud& cloud, const std::string& where) {
  CheckCount(cloud, where);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : cloud.points) mean += p;
  mean /= static_cast<double>(cloud.points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : cloud.points) scatter += (p - mean) * (p - mean).transpose();
  const Eigen::Vector3d spread =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter, Eigen::EigenvaluesOnly)
          .eigenvalues()
          .cwiseMax(0)
          .cwiseSqrt();
  if (!(spread[0] > kFlat * spread[2])) {
    throw Error(where +
                ": all points lie in a plane or on a line, which bounds no solid; scan the "
                "object from more sides");
  }
}

std::vector<char> FindDense(const PointCloud& cloud, double spacing_mm) {
  const VoxelGrid grid = MakeVoxelGrid(cloud.points, 4 * spacing_mm);
  const std::vector<int64_t> counts = CountNeighborhoods(grid);
  std::vector<int64_t> of_points(cloud.points.size());
  for (size_t v = 0; v < counts.size(); ++v) {
    for (int64_t k = grid.offsets[v]; k < grid.offsets[v + 1]; ++k) {
      of_points[grid.points[k]] = counts[v];
    }
  }
  std::vector<int64_t> sorted = of_points;
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  const int64_t needed = std::max<int64_t>(4, sorted[sorted.size() / 2] / 20);
  std::vector<char> keep(cloud.points.size());
  for (size_t i = 0; i < keep.size(); ++i) keep[i] = of_points[i] >= needed;
  return keep;
}

std::vector<char> FindObject(const PointCloud& cloud, double link_mm) {
  const VoxelGrid grid = MakeVoxelGrid(cloud.points, link_mm);
  const std::vector<int> labels = LabelPieces(grid);
  std::vector<int64_t> sizes;
  for (size_t v = 0; v < labels.size(); ++v) {
    if (labels[v] >= static_cast<int>(sizes.size())) sizes.resize(labels[v] + 1);
    sizes[labels[v]] += grid.Count(static_cast<int>(v));
  }
  const int64_t largest = sizes.empty() ? 0 : *std::max_element(sizes.begin(), sizes.end());
  std::vector<char> keep(cloud.points.size());
  for (size_t v = 0; v < labels.size(); ++v) {
    const bool kept = static_cast<double>(sizes[labels[v]]) >= kSmallestPiece * largest;
    for (int64_t k = grid.offsets[v]; k < grid.offsets[v + 1]; ++k) keep[grid.points[k]] = kept;
  }
  return keep;
}

// A patch of area A with unit normal n meets about A (|nx| + |ny| + |nz|) / h^2 cubes of side h;
// over all directions that factor is 1.5.
double EstimateSpacing(const std::vector<Eigen::Vector3d>& points, double extent_mm) {
  const double h = extent_mm / 64;
  const VoxelGrid grid = MakeVoxelGrid(points, h);
  const double area = static_cast<double>(grid.cells.size()) * h * h / 1.5;
  return std::sqrt(area / static_cast<double>(points.size()));
}

}  // namespace

CleanCloud CleanPoints(const PointCloud& points, const CleaningLimits& limits,
                       const std::string& where) {
  CheckCloud(points, where);
  CheckUnit(points, limits, where);
  CleanCloud clean;
  PointCloud cloud = points;
  if (cloud.confidence.empty()) cloud.confidence.assign(cloud.points.size(), 1);
  std::vector<char> keep(cloud.points.size(), 1);
  for (size_t i = 0; i < keep.size(); ++i) {
    const double length = cloud.normals[i].norm();
    const bool wall = cloud.normals[i].z() < kWallCosine * length;
    const double margin_mm = (wall ? kWallMargin : 1) * limits.platform_margin_mm;
    const bool on_platform = cloud.points[i].z() < margin_mm;
    const bool outside =
        (cloud.points[i] - limits.center).norm() > limits.max_distance_mm || !(length > 1e-9);
    clean.platform += on_platform;
    clean.outside += !on_platform && outside;
    keep[i] = !on_platform && !outside;
    if (keep[i]) cloud.normals[i] /= length;
    cloud.confidence[i] = std::clamp(cloud.confidence[i], 1e-3f, 1.0f);
  }
  if (clean.platform == static_cast<int64_t>(keep.size())) {
    std::ostringstream message;
    message << where << ": all " << keep.size() << " points lie below " << limits.platform_margin_mm
            << " mm, on the platform; check the scans, or lower --platform-margin-mm";
    throw Error(message.str());
  }
  cloud = SelectPoints(cloud, keep);
  CheckCount(cloud, where);

  const RobustBox box = MeasureBox(cloud.points);
  keep.assign(cloud.points.size(), 1);
  for (size_t i = 0; i < keep.size(); ++i) {
    keep[i] = (cloud.points[i] - box.center).cwiseAbs().maxCoeff() <= 3 * box.extent;
    clean.outside += !keep[i];
  }
  cloud = SelectPoints(cloud, keep);
  CheckShape(cloud, where);

  keep = FindDense(cloud, EstimateSpacing(cloud.points, box.extent));
  clean.sparse = std::count(keep.begin(), keep.end(), 0);
  cloud = SelectPoints(cloud, keep);
  CheckShape(cloud, where);

  const double spacing_mm = EstimateSpacing(cloud.points, MeasureBox(cloud.points).extent);
  keep = FindObject(cloud, std::max(8 * spacing_mm, box.extent / 80));
  clean.detached = std::count(keep.begin(), keep.end(), 0);
  clean.cloud = SelectPoints(cloud, keep);
  CheckShape(clean.cloud, where);
  clean.spacing_mm = EstimateSpacing(clean.cloud.points, MeasureBox(clean.cloud.points).extent);
  return clean;
}

}  // namespace lfm
