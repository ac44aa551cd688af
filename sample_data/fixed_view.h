// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/camera.h"
#include "core/pose.h"
#include "sample_data/scene_description.h"

namespace lfm {

/// Directions over the upper hemisphere, evenly spread (Fibonacci lattice), unit, z > 0; the first
/// is nearest to the zenith.
std::vector<Eigen::Vector3f> LightStageDirections(int count);

/// Eyes evenly spread over the sphere round `view.target` through `view.eye`; the first is
/// `view.eye` itself.
std::vector<Eigen::Vector3d> ViewSphere(const FixedView& view, int count);

/// The pinhole camera of a fixed view, and where it stands. Throws Error for a size outside
/// [1, 16384], a field of view outside (0, 170) degrees, or an eye at its target.
Camera FixedCamera(const FixedView& view);
Pose FixedPose(const FixedView& view);

}  // namespace lfm
