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

bool IsUsable(const PhotoSight& sight, int x, int y) {
  return sight.usable[static_cast<size_t>(y) * sight.depth.width + x] != 0;
}

/// True when the photograph shows this point (camera frame) of the mesh, and nothing else near it.
bool ShowsPoint(const PhotoSight& sight, const Eigen::Vector3d& point, double tolerance_mm) {
  const auto pixel = Project(sight.camera, point);
  if (!pixel) return false;
  const auto tap = TapAt(sight.depth.width, sight.depth.height, *pixel);
  if (!tap) return false;
  const bool usable = IsUsable(sight, tap->x, tap->y) && IsUsable(sight, tap->x + 1, tap->y) &&
                      IsUsable(sight, tap->x, tap->y + 1) &&
                      IsUsable(sight, tap->x + 1, tap->y + 1);
  if (!usable) return false;
  const DepthMap& map = sight.depth;
  const float top = (1 - tap->fx) * map.At(tap->x, tap->y) + tap->fx * map.At(tap->x + 1, tap->y);
  const float bottom =
      (1 - tap->fx) * map.At(tap->x, tap->y + 1) + tap->fx * map.At(tap->x + 1, tap->y + 1);
  return std::abs((1 - tap->fy) * top + tap->fy * bottom - point.z()) <= tolerance_mm;
}

/// Every point of a triangular grid whose steps are at most one pixel.
bool ShowsTriangle(const PhotoSight& sight, const Corners& corners, double longest_edge_px,
                   double tolerance_mm) {
  for (const Eigen::Vector3d& corner : corners) {
    if (!ShowsPoint(sight, corner, tolerance_mm)) return false;
  }
  const int steps = std::max(1, static_cast<int>(std::ceil(longest_edge_px)));
  for (int j = 0; j <= steps; ++j) {
    for (int i = 0; i + j <= steps; ++i) {
      const double u = static_cast<double>(i) / steps, v = static_cast<double>(j) / steps;
      const Eigen::Vector3d point = (1 - u - v) * corners[0] + u * corners[1] + v * corners[2];
      if (!ShowsPoint(sight, point, tolerance_mm)) return false;
    }
  }
  return true;
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
                                                  const PhotoSight& sight, double max_grazing_deg) {
  const double least_cosine = std::cos(max_grazing_deg * std::numbers::pi / 180);
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
    const double tolerance = pixel_per_mm * depth * (1 + slope) + 2 * deviations_mm[t] / cosine;
    if (!ShowsTriangle(sight, corners, longest, tolerance)) continue;
    visible.push_back({static_cast<int>(t), std::abs(e1.x() * e2.y() - e1.y() * e2.x()) / 2});
  }
  return visible;
}

}  // namespace lfm
