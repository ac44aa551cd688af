// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/pose.h"
#include "scan/scan.h"

namespace lfm {

/// Placements between which the platform turned about one axis before the resting rig:
///   camera_from_world_i = Turn(axis, angle_i) * camera_from_world_0.
/// The axis is a line in the camera's frame, free: it need not be the platform's normal.
struct TurntableRun {
  std::vector<int> members;               ///< placements, ascending; the first has angle 0
  Eigen::Vector3d direction = {0, 0, 1};  ///< unit, camera frame
  Eigen::Vector3d point = {0, 0, 0};      ///< on the axis, nearest to the first platform's origin
  Pose base;                              ///< camera_from_world at angle 0
  std::vector<double> angles;             ///< radians, one a member
  double play_mm = 0.005,
         play_rad = 5e-5;   ///< how well the table keeps its axis: standard deviations
  double rms_mm = 0;        ///< of the members' origins from where the axis puts them
  double chi2_per_dof = 0;  ///< of the members' poses against the axis, by their covariances
};

/// A pose and the covariance of (rotation vector on the left, translation), rad and mm.
struct PoseEstimate {
  Pose camera_from_world;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

/// Finds runs of at least four placements about one axis, largest first: an axis is proposed by
/// each pair of poses, and others join when it brings them within a tolerance. Each run's axis,
/// base and angles are then fitted (Ceres), poses weighed by covariance and play. With kAuto a run
/// stands when its chi^2 per degree of freedom is at most 2; with kOn always. A table that
/// wobbles, or was touched, so loses its run and nothing else.
///
/// None for kOff, for fewer than four poses, and for poses that do not turn (less than 2 degrees).
std::vector<TurntableRun> FindTurntableRuns(const std::vector<PoseEstimate>& poses,
                                            TurntableUse use);

}  // namespace lfm
