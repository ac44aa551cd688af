// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "scan/rig_calibration.h"

namespace lfm {

/// A platform plane n . X = d in the camera's frame and how well it is known beforehand.
///
/// Its unknowns are (a, b, delta): n = normalize(normal + a axis_u + b axis_v),
/// d = distance + delta. Radians and mm.
struct PriorPlane {
  Eigen::Vector3d normal = {0, 0, 1}, axis_u = {1, 0, 0}, axis_v = {0, 1, 0};
  double distance = 0;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of (a, b, delta)
};
PriorPlane PlaneOfPlacement(const PlatePlacement& placement);

/// Camera-frame point where the ray (x, y, 1) meets the plane moved by `shift` = (a, b, delta).
Eigen::Vector3d MeetPlane(const PriorPlane& plane, const Eigen::Vector3d& shift,
                          const Eigen::Vector2d& ray);

/// The unknowns of the adjustment.
struct RigState {
  Camera projector;
  Pose projector_from_camera;
  std::vector<Eigen::Vector3d> plane_shift;  ///< one a placement
};

/// Number of lens terms that enter: 0; 1: k1; 2: k1 k2; 4: k1 k2 p1 p2.
inline constexpr std::array<int, 4> kLensModels = {0, 1, 2, 4};

/// Least squares over `state`, starting from it, with the correspondences of the placements where
/// `included` is true. Residuals are in sigmas (at least `sigma_floor_px`), under a Huber loss.
/// Throws Error when the solver fails.
RigState AdjustRig(const RigState& start, const std::vector<PriorPlane>& planes,
                   const std::vector<PlateCorrespondence>& correspondences,
                   const std::vector<bool>& included, int lens_terms,
                   const RigCalibrationOptions& options);

/// Condition number of the normal matrix of the projector's ten unknowns (fx, fy, cx, cy, rotation,
/// translation) at `state`, planes eliminated, scaled to unit diagonal; 1e300 when singular.
double RigCondition(const RigState& state, const std::vector<PriorPlane>& planes,
                    const std::vector<PlateCorrespondence>& correspondences,
                    const RigCalibrationOptions& options);

/// Predicted minus decoded projector pixel; y is 0 where the row is unknown. No answer where the
/// point is not in front of the projector.
std::optional<Eigen::Vector2d> RigResidualPx(const RigState& state,
                                             const std::vector<PriorPlane>& planes,
                                             const PlateCorrespondence& correspondence);

}  // namespace lfm
