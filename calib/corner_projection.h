// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

#include "core/camera.h"
#include "core/pose.h"

namespace lfm {

/// The intrinsics of a camera in the order in which adjustments hold them:
/// fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6.
inline constexpr int kIntrinsics = 12;
inline constexpr int kFirstLensTerm = 4;
inline constexpr std::array<const char*, kIntrinsics> kIntrinsicNames = {
    "fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};

Eigen::Matrix<double, kIntrinsics, 1> PackIntrinsics(const Camera& camera);
/// `frame` with these intrinsics.
Camera UnpackIntrinsics(const Camera& frame, const Eigen::Matrix<double, kIntrinsics, 1>& values);

/// Where a board point appears, and how that changes. Without the "no answer" of Project: an
/// optimiser needs a cost everywhere. A point at or behind the camera has a large residual that
/// falls as the point comes forward.
struct CornerProjection {
  Eigen::Vector2d residual;  ///< projected minus seen, px
  Eigen::Matrix<double, 2, kIntrinsics> by_intrinsics;
  Eigen::Matrix<double, 2, 6> by_pose;   ///< rotation vector applied on the left, translation
  Eigen::Matrix<double, 2, 3> by_point;  ///< world coordinates
};
CornerProjection ProjectCorner(const Camera& camera, const Pose& camera_from_world,
                               const Eigen::Vector3d& point, const Eigen::Vector2d& seen);
/// Its residual alone.
Eigen::Vector2d CornerResidual(const Camera& camera, const Pose& camera_from_world,
                               const Eigen::Vector3d& point, const Eigen::Vector2d& seen);

/// The pose turned by a rotation vector on the left of its rotation, and shifted.
Pose MovePose(const Pose& pose, const Eigen::Matrix<double, 6, 1>& step);

}  // namespace lfm
