// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/camera.h"
#include "core/pose.h"
#include "scan/plate_correspondences.h"
#include "scan/scan.h"
#include "scan/turntable.h"
#include "scan/uncertainty.h"

namespace lfm {

struct RigCalibrationOptions {
  double robust_scale = 3;       ///< residuals beyond this many sigmas count less (Huber)
  double sigma_floor_px = 0.03;  ///< what decoding cannot know: lens rests, paper that is not flat
  double max_condition = 1e7;    ///< see RigCalibration::condition
  /// Least thickness of the platform points' cloud, relative to its width: below, they lie in one
  /// plane as far as anyone can tell.
  double min_thickness = 0.01;
  /// Of k1, k2, p1, p2; none: as many as placements kept out of the fit ask for.
  std::optional<int> lens_terms = std::nullopt;
};

/// A rig fitted to placements, and how.
struct RigAdjustment {
  RigCalibration rig;
  int used = 0;                 ///< correspondences within robust_scale sigmas
  std::vector<Pose> platforms;  ///< camera_from_world of the placements, adjusted
};

/// Calibrates the projector as an inverse camera.
///
/// For a placement, the platform's plane is known in the camera's frame, so each camera ray has a
/// known 3D point X, and the projector pixel decoded there is the point's picture:
///   projector_px ~ Project(projector, projector_from_camera * X).
/// Start: linear resection (DLT, Hartley & Zisserman 2003, 7.1) over the points of all placements,
/// with outliers trimmed. Then least squares (`scan/rig_adjustment.h`) over fx, fy, cx, cy, lens
/// terms, projector_from_camera, and each placement's pose (held by its corners, or by its
/// covariance). Lens terms enter only when they lower the error of placements left out of the fit.
/// The camera is taken as it is. The result does not depend on the number of threads.
///
/// Throws Error when there are fewer than two placements, fewer than 50 correspondences in one of
/// two placements, when all points lie in one plane (a platform that only turns about its axis), or
/// when the condition number of the projector's 10 x 10 normal matrix (intrinsics and pose, planes
/// eliminated, scaled to unit diagonal) exceeds the limit: the motion cannot calibrate this rig.
RigAdjustment CalibrateRig(const Camera& camera, int projector_width, int projector_height,
                           const std::vector<PlatePlacement>& placements,
                           const std::vector<PlateCorrespondence>& correspondences,
                           const RigCalibrationOptions& options);

/// What the last adjustment of a rig works on: the placements, and the scans' own views of the
/// platform behind them.
struct RigEvidence {
  std::vector<PlatePlacement> placements;
  std::vector<PlateCorrespondence> correspondences;
};

/// What it found.
struct RigRefinement {
  RigCalibration rig;
  std::vector<PoseEstimate> platforms;  ///< one a placement, adjusted
  RigUncertainty uncertainty;
  std::vector<TurntableRun> runs;  ///< that held
  /// Median length of the correspondences' residuals, projector px, one a placement; 0 without.
  std::vector<double> median_px;
};

/// One joint adjustment of camera, projector and all poses of the platform, scans included: camera
/// intrinsics with `camera_terms` lens terms (none: held), the projector unless `rig` was given
/// from elsewhere, and poses, which turntable runs among `scans_begin`.. hold (`use`). Starts from
/// `rig` and the placements' own poses.
///
/// Covariances are of the solution's curvature, given the camera (what its intrinsics leave open,
/// poses and projector move with, and points on the platform hardly feel it), each placement's
/// correspondences counting as no more than kIndependentPoints independent ones: what spoils a
/// point of the plate (print, light from elsewhere, the lens's rest) spoils its neighbours alike.
RigRefinement RefineRig(const RigCalibration& rig, std::optional<int> camera_terms,
                        const RigEvidence& evidence, int scans_begin, TurntableUse use,
                        const RigCalibrationOptions& options);
inline constexpr int kIndependentPoints = 50;

}  // namespace lfm
