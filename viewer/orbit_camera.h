// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/camera.h"
#include "core/pose.h"
#include "core/triangle_mesh.h"

namespace lfm {

/// A camera that circles a target, z up in the picture:
///
///   eye = target + distance (cos elevation cos azimuth, cos elevation sin azimuth, sin elevation)
///
/// Azimuth counts from the world's x axis towards y. The functions below keep every field inside
/// its limits, whatever they are given; non-finite changes are ignored.
struct OrbitCamera {
  static constexpr double kMaxElevation = 89.0 * 3.14159265358979323846 / 180.0;
  static constexpr double kNearest = 1.05;  ///< least distance, in radii of what is framed

  Eigen::Vector3d target = Eigen::Vector3d::Zero();  ///< mm, world
  double azimuth = 0;                                ///< rad, [0, 2 pi)
  double elevation = 0;                              ///< rad, [-kMaxElevation, kMaxElevation]
  double distance = 1000;                            ///< mm, [min_distance, max_distance]
  double vertical_fov = 0.5;                         ///< rad, (0, pi)

  Eigen::Vector3d scene_center = Eigen::Vector3d::Zero();  ///< mm
  double scene_radius = 100;  ///< mm; the target stays within this of scene_center
  double min_distance = 1, max_distance = 1e5;
};

/// A camera whose picture holds the whole mesh with a margin of 8 % in its shorter side,
/// `aspect` = width / height: target at the centre of the vertices' bounding box, azimuth -60 deg
/// (300), elevation 25 deg. A mesh whose vertices all coincide is framed as if it were 1 mm large.
/// Throws Error when the mesh has no vertex, or `vertical_fov` (rad) or `aspect` make no picture
/// (fov in (0, pi), aspect > 0).
OrbitCamera FrameMesh(const TriangleMesh& mesh, double vertical_fov, double aspect);

/// Turns by radians: azimuth wraps round, elevation stops at its limits.
OrbitCamera Orbit(const OrbitCamera& camera, double azimuth_change, double elevation_change);
/// Multiplies the distance; factors that are not positive are ignored.
OrbitCamera Zoom(const OrbitCamera& camera, double factor);
/// Moves the target so that what lies there follows the pointer by (dx, dy) pixels (x right,
/// y down) in a picture of `height` pixels; stays within scene_radius of scene_center, or goes no
/// farther out where it is outside.
OrbitCamera Pan(const OrbitCamera& camera, const Eigen::Vector2d& pixels, int height);

Pose CameraFromWorld(const OrbitCamera& camera);
/// The pinhole of a picture of width x height pixels: square pixels, principal point in the middle.
Camera PinholeCamera(const OrbitCamera& camera, int width, int height);

/// `frames` cameras a full turn round the target, equal steps of azimuth from `start`'s; the last
/// is one step short of the first, so that the film loops. Throws Error unless frames >= 1.
std::vector<OrbitCamera> TurntablePath(const OrbitCamera& start, int frames);

}  // namespace lfm
