// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "calib/board.h"
#include "calib/calib.h"
#include "core/camera.h"
#include "core/pose.h"
#include "scan/decode.h"
#include "scan/scan.h"

namespace lfm {

/// One placement of the platform in front of the rig.
struct PlatePlacement {
  Pose camera_from_world;
  /// Of (rotation vector applied on the left, translation), rad and mm, as PosedImage has it.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

/// A point of the platform seen by the camera and lit by a known place of the projector.
struct PlateCorrespondence {
  int placement = 0;                        ///< index into the placements
  Eigen::Vector2d ray = {0, 0};             ///< (X/Z, Y/Z) of the camera's pixel, undistorted
  Eigen::Vector2d projector_px = {0, 0};    ///< decoded column and row
  Eigen::Vector2d sigma_px = {0.05, 0.05};  ///< standard deviations; row's <= 0: row unknown
};

struct RigCalibrationOptions {
  double robust_scale = 3;       ///< residuals beyond this many sigmas count less (Huber)
  double sigma_floor_px = 0.03;  ///< what decoding cannot know: lens rests, paper that is not flat
  double max_condition = 1e7;    ///< see RigCalibration::condition
  /// Least thickness of the platform points' cloud, relative to its width: below, they lie in one
  /// plane as far as anyone can tell.
  double min_thickness = 0.01;
};

struct RigAdjustment {
  RigCalibration rig;
  int used = 0;        ///< correspondences within robust_scale sigmas
  int lens_terms = 0;  ///< 0; 1: k1; 2: k1 k2; 4: k1 k2 p1 p2
};

/// Correspondences of one decoded placement, at most about `max_count`, on a regular grid of the
/// camera's pixels: inside the printed plate, columns and rows decoded, paper white all round (at
/// an ink border a pixel's light does not come from its middle).
std::vector<PlateCorrespondence> PlateCorrespondences(const DecodedPixels& decoded,
                                                      const std::vector<Eigen::Vector2d>& rays,
                                                      const Board& board,
                                                      const PlatePlacement& placement,
                                                      int placement_index, int max_count);

/// Calibrates the projector as an inverse camera.
///
/// For a placement, the platform's plane is known in the camera's frame, so each camera ray has a
/// known 3D point X, and the projector pixel decoded there is the point's picture:
///   projector_px ~ Project(projector, projector_from_camera * X).
/// Start: linear resection (DLT, Hartley & Zisserman 2003, 7.1) over the points of all placements,
/// with outliers trimmed. Then least squares (Ceres, Huber) over fx, fy, cx, cy, lens terms,
/// projector_from_camera, and each placement's plane (3 unknowns, held by the covariance of its
/// pose). Lens terms enter only when they lower the error of placements left out of the fit.
/// The camera is taken as it is. One thread: the result is reproducible.
///
/// Throws Error when there are fewer than two placements, fewer than 50 correspondences in one of
/// two placements, when all points lie in one plane (a platform that only turns about its axis), or
/// when the condition number of the projector's 10 x 10 normal matrix (intrinsics and pose, planes
/// eliminated, scaled to unit diagonal) exceeds the limit: the motion cannot calibrate this rig.
RigAdjustment CalibrateRig(const Camera& camera, int projector_width, int projector_height,
                           const std::vector<PlatePlacement>& placements,
                           const std::vector<PlateCorrespondence>& correspondences,
                           const RigCalibrationOptions& options);

}  // namespace lfm
