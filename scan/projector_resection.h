// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/camera.h"
#include "core/pose.h"

namespace lfm {

/// One known point and its projector pixel; the row is not used where `has_row` is false.
struct ResectionPoint {
  Eigen::Vector3d point_in_camera = {0, 0, 0};  ///< mm
  Eigen::Vector2d projector_px = {0, 0};
  bool has_row = true;
};

struct Resection {
  Camera projector;  ///< without lens terms; size as given
  Pose projector_from_camera;
};

/// Thickness of a cloud: its smallest standard deviation along any direction over its largest
/// (0 for coplanar points, and for none).
double CloudThickness(const std::vector<ResectionPoint>& points);

/// Linear resection (DLT; Hartley & Zisserman 2003, 7.1, with their normalisation) of a pinhole
/// without skew from points in general position. The worst tenth is trimmed and the fit repeated,
/// three times: a start for a robust adjustment, not a result.
///
/// Throws Error for fewer than 12 points, non-finite input, and points for which no pinhole in
/// front of them exists (a mirrored picture, points in one plane).
Resection ResectProjector(const std::vector<ResectionPoint>& points, int width, int height);

}  // namespace lfm
