// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "scan/rig_calibration.h"
#include "scan/turntable.h"

namespace lfm {

/// The unknowns of the adjustment.
struct RigState {
  Camera camera, projector;
  Pose projector_from_camera;
  std::vector<Pose> platforms;  ///< camera_from_world, one a placement
};

/// Number of projector lens terms that enter: 0; 1: k1; 2: k1 k2; 4: k1 k2 p1 p2.
inline constexpr std::array<int, 4> kLensModels = {0, 1, 2, 4};

/// What is adjusted to what.
struct RigData {
  const std::vector<PlatePlacement>& placements;
  const std::vector<PlateCorrespondence>& correspondences;
  std::vector<bool> included;           ///< one a placement
  std::vector<TurntableRun> runs = {};  ///< placements that share an axis
};

/// Which unknowns move beside the poses of the platform.
struct RigFreedom {
  bool projector = true;    ///< its pinhole and pose
  int projector_terms = 0;  ///< of k1, k2, p1, p2
  std::optional<int> camera_terms =
      std::nullopt;  ///< of k1, k2, p1, p2, k3, k4, k5, k6, with fx fy cx cy; none: camera held
};

/// Least squares over `state`, starting from it (Ceres; Levenberg-Marquardt on the Schur complement
/// of the poses). In sigmas, under Huber's loss:
/// - a correspondence: predicted minus decoded projector pixel of the point where the camera's ray
///   meets the plate (sigma: decoding and `sigma_floor_px`);
/// - a corner: predicted minus seen camera pixel (sigma: robust spread at the start, 0.01 px at
///   least; once more with the spread at the solution where that is less); a placement without
///   corners: distance from the placement's own pose, by its covariance;
/// - a member of a turntable run: distance of its pose from the run's axis, by the table's play.
/// One thread. Throws Error when the solver fails.
RigState AdjustRig(const RigState& start, const RigData& data, const RigFreedom& freedom,
                   const RigCalibrationOptions& options);

/// Condition number of the normal matrix of the projector's ten unknowns (fx, fy, cx, cy, rotation,
/// translation) at `state`, poses eliminated, camera held, scaled to unit diagonal; 1e300 when
/// singular.
double RigCondition(const RigState& state, const RigData& data,
                    const RigCalibrationOptions& options);

/// What a solution's curvature says about its unknowns: covariances that include each other; the
/// camera is held.
struct RigCovariance {
  /// Of fx, fy, cx, cy, k1, k2, p1, p2, rotation vector on the left, translation; 0 where held.
  Eigen::Matrix<double, 14, 14> projector = Eigen::Matrix<double, 14, 14>::Zero();
  std::vector<Eigen::Matrix<double, 6, 6>> platforms;
};
/// Turntable runs are not counted on: the covariances err to the large side. Nothing but zeros when
/// the normal matrix is singular.
RigCovariance ComputeRigCovariance(const RigState& state, const RigData& data,
                                   const RigFreedom& freedom, const RigCalibrationOptions& options);

/// Predicted minus decoded projector pixel; y is 0 where the row is unknown. No answer where the
/// point is not in front of the projector.
std::optional<Eigen::Vector2d> RigResidualPx(const RigState& state,
                                             const PlateCorrespondence& correspondence);

/// RMS (sqrt(mean(dx^2 + dy^2)), px) of all corners at `state`; 0 without corners.
double CornerRmsPx(const RigState& state, const std::vector<PlatePlacement>& placements);

}  // namespace lfm
