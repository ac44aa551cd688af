// SPDX-License-Identifier: BSD-3-Clause
#include "fields/light_frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lfm {
namespace {

constexpr double kHorizon = -1e-9;

}  // namespace

Eigen::Vector3d LightFrame::Local(const Eigen::Vector3d& to_light) const {
  Eigen::Vector3d local = local_from_world * to_light;
  const double length = local.norm();
  if (!(length > 0) || !std::isfinite(length)) return Eigen::Vector3d::UnitZ();
  local /= length;
  if (local.z() >= 0) return local;
  const double across = std::hypot(local.x(), local.y());
  if (across < 1e-12) return Eigen::Vector3d::UnitX();
  return {local.x() / across, local.y() / across, 0};
}

bool LightFrame::IsAbove(const Eigen::Vector3d& to_light) const {
  return (local_from_world * to_light).z() >= kHorizon;
}

LightFrame DomeFrame(const std::vector<Eigen::Vector3d>& to_lights) {
  LightFrame frame;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  bool all_above = true;
  for (const Eigen::Vector3d& to_light : to_lights) {
    mean += to_light;
    all_above = all_above && frame.IsAbove(to_light);
  }
  if (all_above) return frame;
  mean /= static_cast<double>(to_lights.size());
  if (mean.norm() <= 0.1) return frame;
  frame.local_from_world =
      Eigen::Quaterniond::FromTwoVectors(mean, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return frame;
}

LightFrame ViewFrame(const Pose& camera_from_world) {
  LightFrame frame;
  frame.local_from_world = Eigen::Vector3d(1, -1, -1).asDiagonal() * camera_from_world.rotation;
  return frame;
}

}  // namespace lfm
