// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace lfm {

/// A rigid motion between two frames, named `b_from_a`: `p_b = b_from_a * p_a`.
///
/// `rotation` is a proper rotation (orthonormal, determinant +1); `translation` is in millimetres.
struct Pose {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  /// Makes a pose from a quaternion (normalised here; w, x, y, z in files) and a translation.
  static Pose FromQuaternion(const Eigen::Quaterniond& rotation,
                             const Eigen::Vector3d& translation);

  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return rotation * p + translation; }
  /// `c_from_a = c_from_b * b_from_a`.
  Pose operator*(const Pose& b_from_a) const {
    return {rotation * b_from_a.rotation, rotation * b_from_a.translation + translation};
  }
  /// `a_from_b`.
  Pose Inverse() const { return {rotation.transpose(), -(rotation.transpose() * translation)}; }
  /// The origin of frame b seen from frame a: for `camera_from_world`, the camera centre in the
  /// world.
  Eigen::Vector3d Center() const { return -(rotation.transpose() * translation); }
  /// Unit quaternion with w >= 0.
  Eigen::Quaterniond Quaternion() const;
};

/// Angle between two rotations in radians, in [0, pi]; accurate to 1e-12 near zero.
double RotationAngle(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b);

/// Pose `camera_from_world` of a camera at `eye` that looks at `target`, with `up` upwards in the
/// picture (OpenCV axes: x right, y down, z forward). Throws Error if `eye` equals `target` or the
/// direction of view is parallel to `up`.
Pose LookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& up);

}  // namespace lfm
