// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/pose.h"

namespace lfm {

/// The frame in which functions over the hemisphere of lights are fitted: z is its pole, towards
/// the middle of the lights or towards the viewer.
struct LightFrame {
  Eigen::Matrix3d local_from_world = Eigen::Matrix3d::Identity();  ///< a rotation

  /// Unit, z >= 0: a light below the horizon counts as standing on it, in the same compass
  /// direction (straight below: x = 1). A vector that is not finite or zero becomes the pole.
  Eigen::Vector3d Local(const Eigen::Vector3d& to_light) const;
  /// Whether the light stands on the horizon or above (to 1e-9).
  bool IsAbove(const Eigen::Vector3d& to_light) const;
};

/// The world's own frame when no light stands below its xy plane: domes are measured so. Else the
/// pole is the mean of the directions, when that is longer than 0.1; else again the world's z. The
/// rotation is the smallest that does it.
LightFrame DomeFrame(const std::vector<Eigen::Vector3d>& to_lights);

/// The picture's frame, which RTI files mean: x right, y up, z to the viewer.
LightFrame ViewFrame(const Pose& camera_from_world);

}  // namespace lfm
