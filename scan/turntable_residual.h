// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "scan/pose_parameters.h"
#include "scan/turntable.h"

namespace lfm {

/// Unknowns of a run beside its members' poses.
struct RunParameters {
  std::array<double, 4> axis = {0, 0, 0, 0};  ///< tilts of the direction, shifts of the point
  PoseParameters base;
  std::vector<double> angles;
};

/// Two unit vectors across `direction`.
struct AxisFrame {
  Eigen::Vector3d u, v;
  explicit AxisFrame(const Eigen::Vector3d& direction) {
    u = direction.unitOrthogonal();
    v = direction.cross(u);
  }
};

/// How far a pose lies from where the run puts it, whitened: rotation vector (3), origin (3).
struct TurntableResidual {
  Eigen::Matrix3d member_start, base_start;
  Eigen::Vector3d direction, point;
  Eigen::Matrix<double, 6, 6> whitening;

  template <typename T>
  bool operator()(const T* member, const T* axis, const T* base, const T* angle,
                  T* residual) const {
    using Vector = Eigen::Matrix<T, 3, 1>;
    const AxisFrame across(direction);
    const Vector along =
        (direction.cast<T>() + axis[0] * across.u.cast<T>() + axis[1] * across.v.cast<T>())
            .normalized();
    const Vector origin =
        point.cast<T>() + axis[2] * across.u.cast<T>() + axis[3] * across.v.cast<T>();
    const Vector turn = along * angle[0];
    const Eigen::Matrix<T, 3, 3> base_rotation = RotationOf<T>(base_start, base);
    Eigen::Matrix<T, 3, 3> put;
    for (int c = 0; c < 3; ++c) put.col(c) = TurnBy<T>(turn.data(), base_rotation.col(c));
    const Vector from_axis = Vector(base[3], base[4], base[5]) - origin;
    const Vector put_origin = TurnBy<T>(turn.data(), from_axis) + origin;
    Eigen::Map<Eigen::Matrix<T, 6, 1>> out(residual);
    out =
        whitening.cast<T>() * PoseOff<T>(RotationOf<T>(member_start, member),
                                         Vector(member[3], member[4], member[5]), put, put_origin);
    return true;
  }
};

}  // namespace lfm
