// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/rotation.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>

#include "core/pose.h"

namespace lfm {

/// Six unknowns of a pose about a start: a rotation vector applied on the left of the start's
/// rotation, and the translation (rad, mm): no singularity near the solution, and a covariance's
/// parameters at the same time.
using PoseParameters = std::array<double, 6>;

inline PoseParameters PackPose(const Pose& pose) {
  return {0, 0, 0, pose.translation.x(), pose.translation.y(), pose.translation.z()};
}

inline Pose UnpackPose(const Pose& start, const PoseParameters& v) {
  Eigen::Matrix3d turn;
  ceres::AngleAxisToRotationMatrix(v.data(), ceres::ColumnMajorAdapter3x3(turn.data()));
  return Pose::FromQuaternion(Eigen::Quaterniond(Eigen::Matrix3d(turn * start.rotation)),
                              {v[3], v[4], v[5]});
}

/// Turns a vector by a rotation vector.
template <typename T>
Eigen::Matrix<T, 3, 1> TurnBy(const T* rotation_vector, const Eigen::Matrix<T, 3, 1>& v) {
  Eigen::Matrix<T, 3, 1> turned;
  ceres::AngleAxisRotatePoint(rotation_vector, v.data(), turned.data());
  return turned;
}

/// The rotation matrix of `start` turned by the pose's first three parameters.
template <typename T>
Eigen::Matrix<T, 3, 3> RotationOf(const Eigen::Matrix3d& start, const T* pose) {
  Eigen::Matrix<T, 3, 3> rotation;
  for (int c = 0; c < 3; ++c) {
    rotation.col(c) = TurnBy<T>(pose, Eigen::Matrix<T, 3, 1>(start.col(c).template cast<T>()));
  }
  return rotation;
}

/// Lower-triangular L^-1 of covariance = L L^T: what makes a residual of unit variance.
inline Eigen::Matrix<double, 6, 6> WhitenPose(const Eigen::Matrix<double, 6, 6>& covariance) {
  const Eigen::LLT<Eigen::Matrix<double, 6, 6>> factor(covariance);
  return factor.matrixL().solve(Eigen::Matrix<double, 6, 6>::Identity());
}

/// How far one pose lies from a known one: rotation vector on the left (rad; half the skew part of
/// the rotation between them, right to second order) and translation (mm).
template <typename T>
Eigen::Matrix<T, 6, 1> PoseOff(const Eigen::Matrix<T, 3, 3>& rotation,
                               const Eigen::Matrix<T, 3, 1>& translation,
                               const Eigen::Matrix<T, 3, 3>& known_rotation,
                               const Eigen::Matrix<T, 3, 1>& known_translation) {
  const Eigen::Matrix<T, 3, 3> off = rotation * known_rotation.transpose();
  Eigen::Matrix<T, 6, 1> result;
  result << (off(2, 1) - off(1, 2)) / 2.0, (off(0, 2) - off(2, 0)) / 2.0,
      (off(1, 0) - off(0, 1)) / 2.0, translation - known_translation;
  return result;
}

/// How far a pose lies from what was known of it beforehand, whitened; the parameters are about
/// `start_rotation`.
struct PosePrior {
  Eigen::Matrix<double, 6, 6> whitening;
  Pose known;
  Eigen::Matrix3d start_rotation;

  template <typename T>
  bool operator()(const T* pose, T* residual) const {
    using Vector = Eigen::Matrix<T, 3, 1>;
    const Eigen::Matrix<T, 3, 3> known_rotation = known.rotation.cast<T>();
    Eigen::Map<Eigen::Matrix<T, 6, 1>> out(residual);
    out = whitening.cast<T>() * PoseOff<T>(RotationOf<T>(start_rotation, pose),
                                           Vector(pose[3], pose[4], pose[5]), known_rotation,
                                           Vector(known.translation.cast<T>()));
    return true;
  }
};

}  // namespace lfm
