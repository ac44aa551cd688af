// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/shown_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace lfm {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

double Finite(double value) { return std::isfinite(value) ? value : 0; }

}  // namespace

Placement PlacementOf(const ShownModel& model) {
  const auto about = [&](int axis) {
    return Eigen::AngleAxisd(Finite(model.angles_deg[axis]) * kDegree, Eigen::Vector3d::Unit(axis));
  };
  Placement placement;
  placement.world_from_model.rotation = (about(2) * about(1) * about(0)).toRotationMatrix();
  for (int axis = 0; axis < 3; ++axis) {
    placement.world_from_model.translation[axis] = std::clamp(
        Finite(model.translation[axis]), -Placement::kFarthestMm, Placement::kFarthestMm);
  }
  placement.scale = std::isfinite(model.scale)
                        ? std::clamp(model.scale, Placement::kLeastScale, Placement::kMostScale)
                        : 1;
  return placement;
}

ShownModel ShownAt(std::string name, std::filesystem::path file, const Placement& placement) {
  ShownModel model{std::move(name), std::move(file)};
  model.translation = placement.world_from_model.translation;
  model.scale = placement.scale;
  const Eigen::Matrix3d& r = placement.world_from_model.rotation;
  const double y = std::asin(std::clamp(-r(2, 0), -1.0, 1.0));
  // Straight up or down, turns about x and z are one.
  const bool free = std::hypot(r(2, 1), r(2, 2)) > 1e-9;
  const double x = free ? std::atan2(r(2, 1), r(2, 2)) : 0;
  const double z = free ? std::atan2(r(1, 0), r(0, 0)) : std::atan2(-r(0, 1), r(1, 1));
  model.angles_deg = Eigen::Vector3d(x, y, z) / kDegree;
  return model;
}

}  // namespace lfm
