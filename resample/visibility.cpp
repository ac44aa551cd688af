// SPDX-License-Identifier: BSD-3-Clause
#include "resample/visibility.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/parallel.h"
#include "resample/patch_sampling.h"

namespace lfm {
namespace {

using Corners = std::array<Eigen::Vector3d, 3>;

struct ProjectedVertices {
  std::vector<Eigen::Vector3d> in_camera;
  std::vector<std::optional<Eigen::Vector2d>> pixels;
};

ProjectedVertices ProjectVertices(const TriangleMesh& mesh, const PhotoSight& sight) {
  ProjectedVertices projected;
  projected.in_camera.reserve(mesh.vertices.size());
  projected.pixels.reserve(mesh.vertices.size());
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    projected.in_camera.push_back(sight.camera_from_world * vertex);
    projected.pixels.push_back(Project(sight.camera, projected.in_camera.back()));
  }
  return projected;
}

enum class PointSight {
  kHidden,    ///< occluded, outside the frame or the mask
  kNearEdge,  ///< in sight, but its pixels are not data
  kData,
};

PointSight SeePoint(const PhotoSight& sight, const Eigen::Vector3d& point, double tolerance_mm) {
  const auto pixel = Project(sight.camera, point);
  if (!pixel) return PointSight::kHidden;
  const DepthMap& map = sight.depth;
  const auto tap = TapAt(map.width, map.height, *pixel);
  if (!tap) return PointSight::kHidden;
  const auto use_at = [&](int x, int y) {
    return sight.usable[static_cast<size_t>(y) * map.width + x];
  };
  const PixelUse use = std::min({use_at(tap->x, tap->y), use_at(tap->x + 1, tap->y),
                                 use_at(tap->x, tap->y + 1), use_at(tap->x + 1, tap->y + 1)});
  if (use == PixelUse::kForbidden) return PointSight::kHidden;
  if (use == PixelUse::kNearEdge) {
    const float nearest =
        map.At(tap->x + (tap->fx > 0.5F ? 1 : 0), tap->y + (tap->fy > 0.5F ? 1 : 0));
    return point.z() > nearest + tolerance_mm ? PointSight::kHidden : PointSight::kNearEdge;
  }
  const float top = (1 - tap->fx) * map.At(tap->x, tap->y) + tap->fx * map.At(tap->x + 1, tap->y);
  const float bottom =
      (1 - tap->fx) * map.At(tap->x, tap->y + 1) + tap->fx * map.At(tap->x + 1, tap->y + 1);
  const double difference = (1 - tap->fy) * top + tap->fy * bottom - point.z();
  return std::abs(difference) <= tolerance_mm ? PointSight::kData : PointSight::kHidden;
}

/// The share of a triangle's points that is hidden, over a triangular grid whose steps are at most
/// one pixel. No answer when too many are, or too few are data.
std::optional<double> HiddenShare(const PhotoSight& sight, const Corners& corners,
                                  double longest_edge_px, double tolerance_mm,
                                  const VisibilityRule& rule) {
  const auto is_hidden = [&](const Eigen::Vector3d& point) {
    return SeePoint(sight, point, tolerance_mm) == PointSight::kHidden;
  };
  const bool all_of_it = rule.max_hidden_share == 0;  // then most that are not used fail here
  if (all_of_it && std::any_of(corners.begin(), corners.end(), is_hidden)) return std::nullopt;
  const int steps = std::max(1, static_cast<int>(std::ceil(longest_edge_px)));
  const double points = 0.5 * (steps + 1) * (steps + 2);
  const double spare_points = (1 - rule.min_data_share) * points + 1e-9;
  const double spare_hidden = rule.max_hidden_share * points + 1e-9;
  double no_data = 0, hidden = 0;
  for (int j = 0; j <= steps; ++j) {
    for (int i = 0; i + j <= steps; ++i) {
      const double u = static_cast<double>(i) / steps, v = static_cast<double>(j) / steps;
      const Eigen::Vector3d point = (1 - u - v) * corners[0] + u * corners[1] + v * corners[2];
      const PointSight seen = SeePoint(sight, point, tolerance_mm);
      no_data += seen == PointSight::kData ? 0 : 1;
      hidden += seen == PointSight::kHidden ? 1 : 0;
      if (no_data > spare_points || hidden > spare_hidden) return std::nullopt;
    }
  }
  return hidden / points;
}

/// Cosine of the angle between the triangle's normal and the direction to the camera, in the
/// camera's frame; negative infinity for a triangle without area.
double FacingCosine(const Corners& corners) {
  const Eigen::Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  const Eigen::Vector3d centroid = (corners[0] + corners[1] + corners[2]) / 3;
  const double length = normal.norm() * centroid.norm();
  return length > 0 ? -normal.dot(centroid) / length : -HUGE_VAL;
}

}  // namespace

std::vector<double> TriangleDeviations(const TriangleMesh& mesh, const RayScene& surface) {
  constexpr int kSteps = 3;
  std::vector<double> deviations(mesh.triangles.size());
  ParallelFor(
      0, static_cast<int64_t>(mesh.triangles.size()),
      [&](int64_t t) {
        const Eigen::Vector3i& corners = mesh.triangles[static_cast<size_t>(t)];
        double largest = 0;
        for (int j = 0; j <= kSteps; ++j) {
          for (int i = 0; i + j <= kSteps; ++i) {
            const Eigen::Vector3d weights =
                Eigen::Vector3d(kSteps - i - j, i, j) / static_cast<double>(kSteps);
            Eigen::Vector3d point = Eigen::Vector3d::Zero();
            for (int c = 0; c < 3; ++c) {
              point += weights[c] * mesh.vertices[static_cast<size_t>(corners[c])];
            }
            if (const auto closest = surface.Closest(point)) {
              largest = std::max(largest, closest->distance);
            }
          }
        }
        deviations[static_cast<size_t>(t)] = largest;
      },
      64);
  return deviations;
}

std::vector<VisibleTriangle> FindVisibleTriangles(const TriangleMesh& mesh,
                                                  const std::vector<double>& deviations_mm,
                                                  const PhotoSight& sight,
                                                  const VisibilityRule& rule) {
  const double least_cosine = std::cos(rule.max_grazing_deg * std::numbers::pi / 180);
  const double pixel_per_mm = 1 / std::min(sight.camera.fx, sight.camera.fy);
  const ProjectedVertices projected = ProjectVertices(mesh, sight);
  std::vector<VisibleTriangle> visible;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    Corners corners;
    std::array<Eigen::Vector2d, 3> pixels;
    bool in_front = true;
    for (int c = 0; c < 3; ++c) {
      const auto vertex = static_cast<size_t>(mesh.triangles[t][c]);
      corners[static_cast<size_t>(c)] = projected.in_camera[vertex];
      in_front = in_front && projected.pixels[vertex].has_value();
      if (in_front) pixels[static_cast<size_t>(c)] = *projected.pixels[vertex];
    }
    if (!in_front) continue;
    const double cosine = FacingCosine(corners);
    if (!(cosine >= least_cosine)) continue;
    const Eigen::Vector2d e1 = pixels[1] - pixels[0], e2 = pixels[2] - pixels[0];
    const double longest = std::max({e1.norm(), e2.norm(), (e2 - e1).norm()});
    const double depth = std::max({corners[0].z(), corners[1].z(), corners[2].z()});
    const double slope = std::sqrt(std::max(0.0, 1 - cosine * cosine)) / cosine;
    const double pixel_mm = pixel_per_mm * depth, deviation_mm = 2 * deviations_mm[t] / cosine;
    const auto hidden =
        HiddenShare(sight, corners, longest, pixel_mm * (1 + slope) + deviation_mm, rule);
    if (!hidden) continue;
    // A ray through a point meets that point: there the slope over one pixel does not matter.
    visible.push_back({static_cast<int>(t),
                       (1 - *hidden) * std::abs(e1.x() * e2.y() - e1.y() * e2.x()) / 2,
                       *hidden > 0 ? pixel_mm + deviation_mm : 0});
  }
  return visible;
}

}  // namespace lfm
