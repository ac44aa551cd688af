// SPDX-License-Identifier: BSD-3-Clause
#include "scan/plate_correspondences.h"

#include <algorithm>
#include <cmath>

#include "scan/raster_correction.h"

namespace lfm {
namespace {

constexpr double kPlateMarginMm = 1;
constexpr double kFlatWhite = 0.08;  // largest relative spread of white about a correspondence
constexpr int kFlatRadiusPx = 2;

bool IsFlatWhite(const DecodedPixels& decoded, int x, int y) {
  float low = 1e30F, high = 0;
  for (int dy = -kFlatRadiusPx; dy <= kFlatRadiusPx; ++dy) {
    for (int dx = -kFlatRadiusPx; dx <= kFlatRadiusPx; ++dx) {
      const float c = decoded.contrast[static_cast<size_t>(y + dy) * decoded.width + x + dx];
      low = std::min(low, c);
      high = std::max(high, c);
    }
  }
  return high > 0 && high - low <= kFlatWhite * high;
}

}  // namespace

Eigen::Vector3d MeetPlate(const Pose& camera_from_world, const Eigen::Vector2d& ray,
                          const PlatePlane& plate) {
  const Eigen::Vector3d normal = camera_from_world.rotation * plate.normal;
  const Eigen::Vector3d direction = ray.homogeneous();
  return direction *
         ((normal.dot(camera_from_world.translation) + plate.height) / normal.dot(direction));
}

PlatePlane PlateUnderRay(const Pose& camera_from_world, const Eigen::Vector2d& ray,
                         const Eigen::Vector3d& bend_per_mm) {
  if (bend_per_mm.isZero(0)) return {};
  // Newton's method; plates bend by millimetres a metre, so that three steps are exact.
  constexpr int kSteps = 3;
  const Pose world_from_camera = camera_from_world.Inverse();
  PlatePlane plane;
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::Vector3d met = world_from_camera * MeetPlate(camera_from_world, ray, plane);
    if (!met.allFinite()) return {};
    const Eigen::Vector2d p = met.head<2>();
    const Eigen::Vector2d slope(2 * bend_per_mm.x() * p.x() + bend_per_mm.y() * p.y(),
                                bend_per_mm.y() * p.x() + 2 * bend_per_mm.z() * p.y());
    // A quadratic form is half its slope times the place.
    plane.normal = {-slope.x(), -slope.y(), 1};
    plane.height = -slope.dot(p) / 2;
  }
  return plane;
}

std::vector<PlateCorrespondence> PlateCorrespondences(
    const DecodedPixels& decoded, const std::vector<Eigen::Vector2d>& rays, const Board& board,
    const Eigen::Vector3d& bend_per_mm, const PlatePlacement& placement, int max_count) {
  std::vector<PlateCorrespondence> all;
  if (decoded.column.confidence.empty()) return all;
  const bool rows = !decoded.row.confidence.empty();
  const Pose world_from_camera = placement.camera_from_world.Inverse();
  for (int y = kFlatRadiusPx; y + kFlatRadiusPx < decoded.height; ++y) {
    for (int x = kFlatRadiusPx; x + kFlatRadiusPx < decoded.width; ++x) {
      const size_t p = static_cast<size_t>(y) * decoded.width + x;
      if (decoded.column.confidence[p] <= 0 || !IsFlatWhite(decoded, x, y)) continue;
      if (rows && decoded.row.confidence[p] <= 0) continue;
      const PlatePlane plate = PlateUnderRay(placement.camera_from_world, rays[p], bend_per_mm);
      const Eigen::Vector3d point = MeetPlate(placement.camera_from_world, rays[p], plate);
      if (!point.allFinite() || point.z() <= 0) continue;
      const Eigen::Vector3d on_plate = world_from_camera * point;
      if (std::abs(on_plate.x()) > board.width_mm / 2 - kPlateMarginMm ||
          std::abs(on_plate.y()) > board.height_mm / 2 - kPlateMarginMm) {
        continue;
      }
      PlateCorrespondence c;
      c.ray = rays[p];
      c.plate = plate;
      c.projector_px = {decoded.column.position[p], rows ? decoded.row.position[p] : 0.0};
      c.sigma_px = {decoded.column.sigma[p], rows ? decoded.row.sigma[p] : 0.0};
      c.column_slope = SlopeAt(decoded.column, decoded.width, decoded.height, x, y);
      if (rows) c.row_slope = SlopeAt(decoded.row, decoded.width, decoded.height, x, y);
      all.push_back(c);
    }
  }
  const size_t limit = static_cast<size_t>(std::max(1, max_count));
  // An odd stride does not fall into step with rows of even length.
  return EveryNth(all, (all.size() + limit - 1) / limit | 1);
}

}  // namespace lfm
