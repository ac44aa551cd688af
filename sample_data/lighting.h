// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace lfm {

/// A flat rectangular lamp that shines towards `half_u` x `half_v`; radiance is the same all over
/// it and in all directions. World frame, mm; radiance in arbitrary linear units.
struct AreaLight {
  Eigen::Vector3d center = {0, 0, 0};
  Eigen::Vector3d half_u = {1, 0, 0}, half_v = {0, 1, 0};
  Eigen::Vector3f radiance = {1, 1, 1};

  Eigen::Vector3d Normal() const { return half_u.cross(half_v).normalized(); }
  double Area() const { return 4 * half_u.cross(half_v).norm(); }
  /// s, t in [0, 1].
  Eigen::Vector3d Point(double s, double t) const {
    return center + (2 * s - 1) * half_u + (2 * t - 1) * half_v;
  }
};

/// Each lamp is cut into this many cells a side; a cell is what visibility is baked for and what
/// the coat reflects.
inline constexpr int kLightCellsPerSide = 4;
inline constexpr int kLightCells = kLightCellsPerSide * kLightCellsPerSide;
inline constexpr int kMaxLights = 3;

/// The lamps of the studio, and its dim surroundings.
struct Lighting {
  std::vector<AreaLight> lights;  ///< at most kMaxLights
  Eigen::Vector3f sky = {0, 0, 0}, wall = {0, 0, 0}, ground = {0, 0, 0};

  /// Radiance that arrives from the surroundings out of `direction` (unit, away from the point).
  Eigen::Vector3f Environment(const Eigen::Vector3f& direction) const;
};

/// A warm key lamp, a cool broad fill and a rim lamp behind, in a dim room.
Lighting MakeStudioLighting();

/// A lamp at `azimuth_deg`, `elevation_deg` and `distance_mm` from `target`, facing it.
AreaLight AimLight(const Eigen::Vector3d& target, double azimuth_deg, double elevation_deg,
                   double distance_mm, double width_mm, double height_mm,
                   const Eigen::Vector3f& radiance);

}  // namespace lfm
