// SPDX-License-Identifier: BSD-3-Clause
// Includes CGAL's alpha wrapping, which is under GPL-3.
#include "mesh/alpha_wrap.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include <algorithm>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/ray_scene.h"
#include "mesh/carving.h"
#include "mesh/nearest_points.h"
#include "mesh/surface_distance.h"

namespace lfm {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

constexpr size_t kFewestPoints = 4;
constexpr double kLeastAlphaInSpacings = 3;
constexpr double kThinInAlphas = 0.25, kThinInOffsets = 3;
constexpr double kMostNewlyThin = 0.1;
constexpr size_t kLookedAt = 5000;
// Samples in a square of one spacing: no circle of three spacings about is left without one.
constexpr double kWallDensity = 2;
// The gap between wall and data, so narrow that neither this alpha nor half of it enters.
constexpr double kGapInAlphas = 0.5;
constexpr double kBorderInSpacings = 1.5;
constexpr int64_t kMostWallSamples = 1000000;

TriangleMesh WrapOnce(const std::vector<Kernel::Point_3>& points, double alpha_mm,
                      double offset_mm) {
  SurfaceMesh wrap;
  try {
    CGAL::alpha_wrap_3(points, alpha_mm, offset_mm, wrap);
  } catch (const std::exception& e) {
    throw Error(std::string("reconstruction: alpha wrapping failed: ") + e.what());
  }
  TriangleMesh mesh;
  std::vector<int> index(wrap.num_vertices() + wrap.number_of_removed_vertices(), -1);
  for (const auto v : wrap.vertices()) {
    index[v.idx()] = static_cast<int>(mesh.vertices.size());
    const auto& p = wrap.point(v);
    mesh.vertices.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto f : wrap.faces()) {
    Eigen::Vector3i triangle;
    int k = 0;
    for (const auto v : wrap.vertices_around_face(wrap.halfedge(f))) {
      if (k < 3) triangle[k++] = index[v.idx()];
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

// What closes holes in the data: places of wraps that were not yet entered.
class Wall {
 public:
  Wall(const PointCloud& data, const FreeSpace& free, double spacing_mm)
      : cloud_(data), data_(data.points), free_(free), spacing_mm_(spacing_mm) {}

  // Adds the wrap's places that lie farther than `clearance_mm` from all data, and are not free;
  // and where the free space inside the wrap ends, since a hole may lie at the bottom of a hollow
  // that was seen into. True when most places are free.
  bool Raise(const TriangleMesh& wrap, double clearance_mm) {
    const double wanted = kWallDensity * TotalArea(wrap) / (spacing_mm_ * spacing_mm_);
    const auto count = static_cast<int64_t>(std::min<double>(wanted, kMostWallSamples)) + 1;
    int64_t free = 0, added = 0;
    for (const Eigen::Vector3d& p : SampleSurface(wrap, count, 1).points) {
      const double distance = data_.Find(p, 1).front().distance;
      if (distance <= kGapInAlphas * kLeastAlphaInSpacings * spacing_mm_) continue;
      const bool is_free = free_.IsFree(p), is_far = distance > clearance_mm;
      free += is_far && is_free;
      added += is_far && !is_free;
      if (is_far && !is_free) points_.push_back(p);
      if (!is_far && !is_free) edge_.push_back({p, distance});
    }
    const PointCloud border =
        FindCarvedBorder(wrap, free_, cloud_, kBorderInSpacings * spacing_mm_, clearance_mm);
    points_.insert(points_.end(), border.points.begin(), border.points.end());
    return free > added;
  }

  // Adds what joins it and lies farther than `clearance_mm` from all data.
  void Widen(double clearance_mm) {
    if (points_.empty()) return;
    std::vector<Eigen::Vector3d> added;
    {
      const NearestPoints wall(points_);
      std::erase_if(edge_, [&](const EdgePoint& p) {
        const double reach = 3 * clearance_mm + spacing_mm_;
        const bool joins =
            p.from_data_mm > clearance_mm && wall.Find(p.point, 1).front().distance < reach;
        if (joins) added.push_back(p.point);
        return joins;
      });
    }
    points_.insert(points_.end(), added.begin(), added.end());
  }

  const std::vector<Eigen::Vector3d>& points() const { return points_; }

 private:
  struct EdgePoint {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    double from_data_mm = 0;
  };
  const PointCloud& cloud_;
  const NearestPoints data_;
  const FreeSpace& free_;
  double spacing_mm_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<EdgePoint> edge_;  ///< places between the wall and the data
};

// Share of the data under which the wrap is thinner than `thin_mm`: from a point away from the
// nearest place of the wrap, its other side comes that soon.
double ThinShare(const TriangleMesh& wrap, const std::vector<Eigen::Vector3d>& data,
                 double thin_mm) {
  const RayScene scene(wrap);
  const size_t stride = data.size() / kLookedAt + 1;
  int64_t thin = 0, all = 0;
  for (size_t i = 0; i < data.size(); i += stride) {
    const auto closest = scene.Closest(data[i]);
    if (!closest || !(closest->distance > 0)) continue;
    const auto other_side =
        scene.Intersect(data[i], (data[i] - closest->point) / closest->distance, 0);
    thin += other_side && other_side->distance < thin_mm;
    ++all;
  }
  return all > 0 ? static_cast<double>(thin) / static_cast<double>(all) : 0;
}

// Inside a shell, the wrap lies on both sides of its points.
bool FellThrough(const TriangleMesh& finer, const TriangleMesh& before,
                 const std::vector<Eigen::Vector3d>& data, double alpha_mm, double offset_mm) {
  if (finer.triangles.empty()) return true;
  // Facets as wide as alpha lie off a curved shell, others by the offset.
  const double thin_mm = std::max(kThinInAlphas * alpha_mm, kThinInOffsets * offset_mm);
  return ThinShare(finer, data, thin_mm) > ThinShare(before, data, thin_mm) + kMostNewlyThin;
}

}  // namespace

WrapResult WrapPoints(const PointCloud& cloud, double spacing_mm, double offset_mm,
                      const FreeSpace& free) {
  if (cloud.points.size() < kFewestPoints) {
    throw Error("reconstruction: " + std::to_string(cloud.points.size()) +
                " points cannot be wrapped; at least 4 are needed");
  }
  Eigen::Vector3d low = cloud.points.front(), high = low;
  for (const Eigen::Vector3d& p : cloud.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  Wall wall(cloud, free, spacing_mm);
  const auto wrap = [&](double alpha_mm) {
    std::vector<Kernel::Point_3> points;
    for (const auto* some : {&cloud.points, &wall.points()}) {
      for (const Eigen::Vector3d& p : *some) points.emplace_back(p.x(), p.y(), p.z());
    }
    return WrapOnce(points, alpha_mm, offset_mm);
  };
  const double least = kLeastAlphaInSpacings * spacing_mm;
  WrapResult result;
  result.alpha_mm = std::max((high - low).norm(), least);
  result.mesh = wrap(result.alpha_mm);
  if (result.mesh.triangles.empty()) throw Error("reconstruction: the wrap holds nothing");
  while (result.alpha_mm > least) {
    const double alpha_mm = std::max(0.5 * result.alpha_mm, least);
    wall.Widen(kGapInAlphas * alpha_mm);
    TriangleMesh finer = wrap(alpha_mm);
    if (FellThrough(finer, result.mesh, cloud.points, alpha_mm, offset_mm)) {
      const bool seen_through = wall.Raise(result.mesh, kGapInAlphas * alpha_mm);
      finer = wrap(alpha_mm);
      if (!seen_through && FellThrough(finer, result.mesh, cloud.points, alpha_mm, offset_mm))
        break;
    }
    if (finer.triangles.empty()) break;
    result.mesh = std::move(finer);
    result.alpha_mm = alpha_mm;
  }
  result.wall_points = static_cast<int64_t>(wall.points().size());
  return result;
}

}  // namespace lfm
