// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>

#include "viewer/scene.h"

namespace lfm {

/// A model of the window's scene as its user moves it: turned about the world's x, then y, then z
/// axis, after scaling.
struct ShownModel {
  std::string name;
  std::filesystem::path file;
  Eigen::Vector3d translation = {0, 0, 0};  ///< mm
  Eigen::Vector3d angles_deg = {0, 0, 0};   ///< about x, y and z
  double scale = 1;                         ///< [1e-6, 1e6]

  bool operator==(const ShownModel&) const = default;
};

/// Where it stands. What is not finite, or out of range, is taken as in range.
Placement PlacementOf(const ShownModel& model);
/// The angles of a placement's rotation, y within [-90, 90].
ShownModel ShownAt(std::string name, std::filesystem::path file, const Placement& placement);

}  // namespace lfm
