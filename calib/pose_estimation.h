// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/bundle_adjustment.h"
#include "core/camera.h"

namespace lfm {

/// Focal length (pixels) from homographies `pixel_from_plane` of one plane seen from several
/// directions, for square pixels, no lens distortion and the principal point in the middle of a
/// width x height picture: least squares over the two equations a view of Zhang ("A flexible new
/// technique for camera calibration", 2000, Eq. 3 and 4).
///
/// No answer when there is no view or the views do not tell it (all head-on, or contradictory):
/// results outside 0.2 to 50 picture widths are refused.
std::optional<double> FocalFromHomographies(const std::vector<Eigen::Matrix3d>& pixel_from_plane,
                                            int width, int height);

/// The pose of a camera from corners of the plane z = 0. A plane seen from far has two likely poses
/// (Collins and Bartoli, "Infinitesimal plane-based pose estimation", 2014): both are refined by
/// least squares with the Cauchy loss, and the one with the lower loss is returned.
///
/// No answer for fewer than four corners, corners on a line, pixels that the lens model cannot
/// unproject, or when neither pose has the plane in front of the camera.
std::optional<Pose> EstimatePlanarPose(const Camera& camera,
                                       const std::vector<Eigen::Vector3d>& points,
                                       const std::vector<Eigen::Vector2d>& pixels,
                                       double robust_scale_px);

}  // namespace lfm
