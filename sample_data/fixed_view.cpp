// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/fixed_view.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace lfm {
namespace {

using V3d = Eigen::Vector3d;
using V3f = Eigen::Vector3f;

constexpr double kGoldenAngle = std::numbers::pi * 0.7639320225002102;  // (3 - sqrt 5) pi

}  // namespace

std::vector<V3f> LightStageDirections(int count) {
  if (count < 1) throw Error("a light stage needs at least one light");
  std::vector<V3f> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (i + 0.5) / count, r = std::sqrt(1 - z * z), a = kGoldenAngle * i;
    directions.push_back(V3d(r * std::cos(a), r * std::sin(a), z).normalized().cast<float>());
  }
  return directions;
}

std::vector<V3d> ViewSphere(const FixedView& view, int count) {
  const V3d axis = view.eye - view.target;
  const double radius = axis.norm();
  if (!(radius > 0)) throw Error("the view's eye stands at its target");
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(V3d::UnitZ(), axis);
  std::vector<V3d> eyes = {view.eye};
  for (int i = 1; i < count; ++i) {
    const double z = 1 - 2.0 * i / count, r = std::sqrt(std::max(0.0, 1 - z * z));
    const double a = kGoldenAngle * i;
    eyes.push_back(view.target + radius * (turn * V3d(r * std::cos(a), r * std::sin(a), z)));
  }
  return eyes;
}

Camera FixedCamera(const FixedView& view) {
  if (view.width < 1 || view.height < 1 || view.width > 16384 || view.height > 16384) {
    throw Error("a view has 1 to 16384 pixels a side");
  }
  if (!(view.fov_deg > 0 && view.fov_deg < 170)) {
    throw Error("a view's field of view lies between 0 and 170 degrees");
  }
  Camera camera;
  camera.width = view.width;
  camera.height = view.height;
  camera.fx = camera.fy = 0.5 * view.width / std::tan(view.fov_deg * std::numbers::pi / 360);
  camera.cx = (view.width - 1) / 2.0;
  camera.cy = (view.height - 1) / 2.0;
  return camera;
}

Pose FixedPose(const FixedView& view) {
  if (!((view.eye - view.target).norm() > 0)) throw Error("the view's eye stands at its target");
  const V3d axis = (view.eye - view.target).normalized();
  return LookAt(view.eye, view.target, std::abs(axis.z()) < 0.999 ? V3d::UnitZ() : V3d::UnitY());
}

}  // namespace lfm
