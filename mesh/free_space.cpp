// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/free_space.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

constexpr size_t kFewestPoints = 100;
constexpr int kFewestCells = 6;   // of nine
constexpr int kMostCells = 4096;  // along a side
// Nothing is seen farther than this from the middle of a view.
constexpr double kLeastCosine = 0.3;

// Coordinates in a view; no answer behind it or far to the side.
std::optional<Eigen::Vector2d> InView(const Eigen::Matrix3d& view_from_world,
                                      const Eigen::Vector3d& from_eye) {
  const Eigen::Vector3d p = view_from_world * from_eye;
  if (!(p.z() > kLeastCosine * p.norm())) return std::nullopt;
  return p.head<2>() / p.z();
}

}  // namespace

std::vector<ScanSight> SightsOf(const ScanResult& scan) {
  std::vector<ScanSight> sights;
  int64_t first = 0;
  for (const ScanCloud& part : scan.scans) {
    ScanSight sight;
    sight.first = first;
    sight.last = first += static_cast<int64_t>(part.cloud.points.size());
    sight.eyes = {part.camera_from_world.Center(),
                  (scan.rig.projector_from_camera * part.camera_from_world).Center()};
    sights.push_back(sight);
  }
  // Not the scans one after the other: then nobody can tell which point is whose.
  if (first != static_cast<int64_t>(scan.points.points.size())) sights.clear();
  return sights;
}

FreeSpace::View FreeSpace::MakeView(const Eigen::Vector3d& eye,
                                    const std::vector<Eigen::Vector3d>& points) {
  View view;
  view.eye = eye;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) {
    const double distance = (p - eye).norm();
    if (distance > 0) middle += (p - eye) / distance;
  }
  if (points.size() < kFewestPoints || !(middle.norm() > 0)) return view;
  view.view_from_world =
      Eigen::Quaterniond::FromTwoVectors(middle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9), high = -low;
  std::vector<Eigen::Vector2d> places;
  std::vector<float> distances;
  for (const Eigen::Vector3d& p : points) {
    const auto place = InView(view.view_from_world, p - eye);
    if (!place) continue;
    places.push_back(*place);
    distances.push_back(static_cast<float>((p - eye).norm()));
    low = low.cwiseMin(*place);
    high = high.cwiseMax(*place);
  }
  const Eigen::Vector2d extent = high - low;
  if (places.size() < kFewestPoints || !(extent.minCoeff() > 0)) return view;
  view.low = low;
  // As many cells in the box as points, or more where the object does not fill it.
  view.cell = std::max(std::sqrt(extent.prod() / static_cast<double>(places.size())),
                       extent.maxCoeff() / kMostCells);
  view.columns = static_cast<int>(extent.x() / view.cell) + 1;
  view.rows = static_cast<int>(extent.y() / view.cell) + 1;
  std::vector<float> nearest(static_cast<size_t>(view.columns) * view.rows, 0);
  for (size_t i = 0; i < places.size(); ++i) {
    const Eigen::Vector2i cell = ((places[i] - low) / view.cell).cast<int>();
    float& n = nearest[static_cast<size_t>(cell.y()) * view.columns + cell.x()];
    if (n == 0 || distances[i] < n) n = distances[i];
  }
  view.nearest_mm.assign(nearest.size(), 0);
  for (int y = 1; y + 1 < view.rows; ++y) {
    for (int x = 1; x + 1 < view.columns; ++x) {
      int count = 0;
      float least = INFINITY;
      for (int k = 0; k < 9; ++k) {
        const float n = nearest[static_cast<size_t>(y + k / 3 - 1) * view.columns + x + k % 3 - 1];
        if (n == 0) continue;
        ++count;
        least = std::min(least, n);
      }
      const size_t at = static_cast<size_t>(y) * view.columns + x;
      if (count >= kFewestCells) view.nearest_mm[at] = least;
    }
  }
  return view;
}

FreeSpace::FreeSpace(const PointCloud& points, const std::vector<ScanSight>& sights,
                     double margin_mm)
    : margin_mm_(margin_mm) {
  struct Task {
    Eigen::Vector3d eye;
    const ScanSight* sight;
  };
  std::vector<Task> tasks;
  for (const ScanSight& sight : sights) {
    if (sight.first < 0 || sight.last < sight.first ||
        sight.last > static_cast<int64_t>(points.points.size())) {
      throw Error("free space: a scan's points are not in the cloud");
    }
    for (const Eigen::Vector3d& eye : sight.eyes) {
      if (eye.allFinite()) tasks.push_back({eye, &sight});
    }
  }
  views_.resize(tasks.size());
  ParallelFor(0, static_cast<int64_t>(tasks.size()), [&](int64_t i) {
    std::vector<Eigen::Vector3d> seen;
    for (int64_t p = tasks[i].sight->first; p < tasks[i].sight->last; ++p) {
      if (points.points[p].allFinite()) seen.push_back(points.points[p]);
    }
    views_[i] = MakeView(tasks[i].eye, seen);
  });
  std::erase_if(views_, [](const View& view) { return view.nearest_mm.empty(); });
}

bool FreeSpace::IsFree(const Eigen::Vector3d& place) const {
  return std::any_of(views_.begin(), views_.end(), [&](const View& view) {
    const auto at = InView(view.view_from_world, place - view.eye);
    if (!at) return false;
    const Eigen::Vector2d cell = (*at - view.low) / view.cell;
    if (!(cell.minCoeff() >= 0) || cell.x() >= view.columns || cell.y() >= view.rows) return false;
    const float nearest = view.nearest_mm[static_cast<size_t>(cell.y()) * view.columns +
                                          static_cast<size_t>(cell.x())];
    return nearest > 0 && (place - view.eye).norm() + margin_mm_ < nearest;
  });
}

}  // namespace lfm
