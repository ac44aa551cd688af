// SPDX-License-Identifier: BSD-3-Clause
#include "core/pose.h"

#include <cmath>

#include "core/error.h"

namespace lfm {

Pose Pose::FromQuaternion(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation) {
  if (!(rotation.norm() > 0) || !rotation.coeffs().allFinite() || !translation.allFinite()) {
    throw Error("pose: a rotation quaternion must be finite and not zero");
  }
  return {rotation.normalized().toRotationMatrix(), translation};
}

Eigen::Quaterniond Pose::Quaternion() const {
  Eigen::Quaterniond q(rotation);
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  return q;
}

double RotationAngle(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  // acos of the trace loses half the digits near zero; the skew part does not.
  const Eigen::Matrix3d d = a.transpose() * b;
  const Eigen::Vector3d skew(d(2, 1) - d(1, 2), d(0, 2) - d(2, 0), d(1, 0) - d(0, 1));
  return std::atan2(skew.norm(), d.trace() - 1);
}

Pose LookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& up) {
  const Eigen::Vector3d z = target - eye;
  const Eigen::Vector3d x = z.cross(up);
  constexpr double kParallel_rel = 1e-9;
  if (!(x.norm() > kParallel_rel * z.norm() * up.norm())) {
    throw Error("look-at: the direction of view is zero or parallel to 'up'");
  }
  Pose camera_from_world;
  camera_from_world.rotation.row(0) = x.normalized();
  camera_from_world.rotation.row(2) = z.normalized();
  camera_from_world.rotation.row(1) = z.cross(x).normalized();
  camera_from_world.translation = -(camera_from_world.rotation * eye);
  return camera_from_world;
}

}  // namespace lfm
