// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "scan/scan.h"

namespace lfm {

/// How well the rig's projector is known, given the camera: covariance of fx, fy, cx, cy, k1, k2,
/// p1, p2, and of its pose as (rotation vector on the left, translation); rad, mm. Zero where a
/// number was given.
struct RigUncertainty {
  Eigen::Matrix<double, 14, 14> projector = Eigen::Matrix<double, 14, 14>::Zero();
};

/// Standard deviation (projector px) of the column at which the projector lights `point_in_camera`,
/// from what is not known of the projector: sqrt(J C J^T). 0 where the point is not lit.
double ColumnSigmaPx(const RigCalibration& rig, const RigUncertainty& uncertainty,
                     const Eigen::Vector3d& point_in_camera);

/// Variance (mm^2) across a surface of normal n from the covariance C of camera_from_world
/// (rotation vector w on the left, translation t): a point that lies `arm` from the platform's
/// origin (camera frame) is off by w x arm + t, hence a C a^T with a = [arm x n, n].
double PoseVarianceMm2(const Eigen::Matrix<double, 6, 6>& covariance,
                       const Eigen::Vector3d& arm_in_camera,
                       const Eigen::Vector3d& normal_in_camera);

}  // namespace lfm
