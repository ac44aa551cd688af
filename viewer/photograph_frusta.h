// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/camera.h"
#include "core/pose.h"
#include "viewer/camera_file.h"
#include "viewer/photographs.h"

namespace lfm {

/// A photograph's camera as lines to draw in the world: from the eye to the corners of its picture
/// (the outer corners of its corner pixels, through its own lens) at `depth` mm along its axis, the
/// straight frame through these, and a mark above the frame's upper edge; pairs of points. A corner
/// that the lens model folds back before stands where it would without distortion.
std::vector<Eigen::Vector3d> FrustumLines(const PosedCamera& camera, double depth);

/// The index of the photograph whose drawn frustum (FrustumLines at `depth`) lies nearest to pixel
/// `at`, within `reach` pixels of one of its lines; of equally near ones the first. -1 when none
/// does. `camera` is a pinhole; of lines that reach behind it, what lies in front counts, be it off
/// the picture.
int PickFrustum(const std::vector<PosedPhotograph>& photographs, double depth, const Camera& camera,
                const Pose& camera_from_world, const Eigen::Vector2d& at, double reach);

}  // namespace lfm
