// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/photograph_frusta.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>

namespace lfm {
namespace {

constexpr double kNear_rel = 1e-4;  // of the frusta's depth; nothing nearer to the eye is picked

/// The point at Z = depth that the lens shows at `pixel`, in the camera frame.
Eigen::Vector3d PointAt(const Camera& camera, const Eigen::Vector2d& pixel, double depth) {
  const Eigen::Vector3d pinhole((pixel.x() - camera.cx) / camera.fx,
                                (pixel.y() - camera.cy) / camera.fy, 1);
  const Eigen::Vector3d direction = TryUnproject(camera, pixel).value_or(pinhole);
  return direction * (depth / direction.z());
}

/// Pixels from `at` to what is in front of the eye of the line from `a` to `b` (camera frame).
double PixelsFrom(const Camera& camera, const Eigen::Vector2d& at, Eigen::Vector3d a,
                  Eigen::Vector3d b, double near) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  if (a.z() > b.z()) std::swap(a, b);
  if (!(b.z() > near)) return kNone;
  if (a.z() < near) a += (b - a) * ((near - a.z()) / (b.z() - a.z()));
  const std::optional<Eigen::Vector2d> begin = Project(camera, a), end = Project(camera, b);
  if (!begin || !end) return kNone;
  const Eigen::Vector2d along = *end - *begin;
  const double length2 = along.squaredNorm();
  const double share = length2 > 0 ? std::clamp(along.dot(at - *begin) / length2, 0.0, 1.0) : 0.0;
  return (at - *begin - share * along).norm();
}

}  // namespace

std::vector<Eigen::Vector3d> FrustumLines(const PosedCamera& camera, double depth) {
  const Camera& lens = camera.camera;
  const Pose world_from_camera = camera.camera_from_world.Inverse();
  const Eigen::Vector3d eye = camera.camera_from_world.Center();
  const double right = lens.width - 0.5, bottom = lens.height - 0.5;
  const std::array<Eigen::Vector2d, 4> pixels = {
      Eigen::Vector2d(-0.5, -0.5), {right, -0.5}, {right, bottom}, {-0.5, bottom}};
  std::array<Eigen::Vector3d, 4> corners;
  for (size_t i = 0; i < 4; ++i) {
    corners[i] = world_from_camera * PointAt(lens, pixels[i], depth);
  }
  std::vector<Eigen::Vector3d> lines;
  for (size_t i = 0; i < 4; ++i) {
    lines.insert(lines.end(), {eye, corners[i], corners[i], corners[(i + 1) % 4]});
  }
  constexpr double kMarkHalfWidth_rel = 0.15, kMarkHeight_rel = 0.25;  // of the frame's sides
  const Eigen::Vector3d middle = (corners[0] + corners[1]) / 2;
  const Eigen::Vector3d aside = kMarkHalfWidth_rel * (corners[1] - corners[0]);
  const Eigen::Vector3d tip = middle + kMarkHeight_rel * (middle - (corners[2] + corners[3]) / 2);
  lines.insert(lines.end(), {middle - aside, tip, tip, middle + aside});
  return lines;
}

int PickFrustum(const std::vector<PosedPhotograph>& photographs, double depth, const Camera& camera,
                const Pose& camera_from_world, const Eigen::Vector2d& at, double reach) {
  int nearest = -1;
  double least = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < photographs.size(); ++i) {
    const std::vector<Eigen::Vector3d> lines = FrustumLines(photographs[i].camera, depth);
    for (size_t k = 0; k + 1 < lines.size(); k += 2) {
      const double pixels = PixelsFrom(camera, at, camera_from_world * lines[k],
                                       camera_from_world * lines[k + 1], kNear_rel * depth);
      if (!(pixels <= reach && pixels < least)) continue;
      least = pixels;
      nearest = static_cast<int>(i);
    }
  }
  return nearest;
}

}  // namespace lfm
