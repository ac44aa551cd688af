// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/orbit_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace lfm {
namespace {

constexpr double kFramingMargin = 0.08;
constexpr double kDefaultAzimuthDeg = 300;
constexpr double kDefaultElevationDeg = 25;
constexpr double kRadiansPerDegree = std::numbers::pi / 180;

double WrapAngle(double angle) {
  const double turn = 2 * std::numbers::pi;
  const double wrapped = angle - turn * std::floor(angle / turn);
  return wrapped < turn ? wrapped : 0;
}

Eigen::Vector3d DirectionToEye(const OrbitCamera& camera) {
  return {std::cos(camera.elevation) * std::cos(camera.azimuth),
          std::cos(camera.elevation) * std::sin(camera.azimuth), std::sin(camera.elevation)};
}

}  // namespace

OrbitCamera FrameMesh(const TriangleMesh& mesh, double vertical_fov, double aspect) {
  if (mesh.vertices.empty()) throw Error("there is nothing to look at: the mesh has no vertex");
  if (!(vertical_fov > 0 && vertical_fov < std::numbers::pi) || !(aspect > 0) ||
      !std::isfinite(aspect)) {
    throw Error(
        "the field of view or the picture's size makes no picture; choose a field of "
        "view between 0 and 180 degrees");
  }
  Eigen::Vector3d low = mesh.vertices[0], high = mesh.vertices[0];
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  OrbitCamera camera;
  camera.scene_center = camera.target = (low + high) / 2;
  double radius = 0;
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    radius = std::max(radius, (vertex - camera.target).norm());
  }
  if (!(radius > 0)) radius = 1;
  camera.scene_radius = radius;
  camera.vertical_fov = vertical_fov;
  camera.azimuth = kDefaultAzimuthDeg * kRadiansPerDegree;
  camera.elevation = kDefaultElevationDeg * kRadiansPerDegree;
  // The cone that touches the bounding sphere fits in the shorter side, less the margin.
  const double half_tangent =
      std::tan(vertical_fov / 2) * std::min(1.0, aspect) * (1 - kFramingMargin);
  camera.distance = radius * std::sqrt(1 + 1 / (half_tangent * half_tangent));
  camera.min_distance = std::min(OrbitCamera::kNearest * radius, camera.distance);
  camera.max_distance = std::max(50 * radius, 2 * camera.distance);
  return camera;
}

OrbitCamera Orbit(const OrbitCamera& camera, double azimuth_change, double elevation_change) {
  OrbitCamera turned = camera;
  if (std::isfinite(azimuth_change)) turned.azimuth = WrapAngle(camera.azimuth + azimuth_change);
  if (std::isfinite(elevation_change)) {
    turned.elevation = std::clamp(camera.elevation + elevation_change, -OrbitCamera::kMaxElevation,
                                  OrbitCamera::kMaxElevation);
  }
  return turned;
}

OrbitCamera Zoom(const OrbitCamera& camera, double factor) {
  OrbitCamera zoomed = camera;
  if (std::isfinite(factor) && factor > 0) {
    zoomed.distance =
        std::clamp(camera.distance * factor, camera.min_distance, camera.max_distance);
  }
  return zoomed;
}

OrbitCamera Pan(const OrbitCamera& camera, const Eigen::Vector2d& pixels, int height) {
  OrbitCamera moved = camera;
  if (!pixels.allFinite() || height < 1) return moved;
  const double mm_per_pixel = 2 * camera.distance * std::tan(camera.vertical_fov / 2) / height;
  const Eigen::Matrix3d camera_from_world = CameraFromWorld(camera).rotation;
  const Eigen::Vector3d right = camera_from_world.row(0), down = camera_from_world.row(1);
  moved.target -= mm_per_pixel * (pixels.x() * right + pixels.y() * down);
  const Eigen::Vector3d offset = moved.target - camera.scene_center;
  // A target that is outside already, since the scene has changed, does not jump back.
  const double reach = std::max(camera.scene_radius, (camera.target - camera.scene_center).norm());
  if (offset.norm() > reach) moved.target = camera.scene_center + offset.normalized() * reach;
  return moved;
}

Pose CameraFromWorld(const OrbitCamera& camera) {
  const Eigen::Vector3d eye = camera.target + camera.distance * DirectionToEye(camera);
  return LookAt(eye, camera.target, Eigen::Vector3d::UnitZ());
}

Camera PinholeCamera(const OrbitCamera& camera, int width, int height) {
  Camera pinhole;
  pinhole.width = width;
  pinhole.height = height;
  pinhole.fx = pinhole.fy = height / (2 * std::tan(camera.vertical_fov / 2));
  pinhole.cx = (width - 1) / 2.0;
  pinhole.cy = (height - 1) / 2.0;
  return pinhole;
}

std::vector<OrbitCamera> TurntablePath(const OrbitCamera& start, int frames) {
  if (frames < 1) throw Error("a turntable needs at least one frame");
  std::vector<OrbitCamera> path;
  path.reserve(frames);
  for (int i = 0; i < frames; ++i) {
    path.push_back(Orbit(start, 2 * std::numbers::pi * i / frames, 0));
  }
  return path;
}

}  // namespace lfm
