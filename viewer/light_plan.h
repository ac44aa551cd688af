// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace lfm {

/// The light of one frame of a film.
struct FrameLight {
  double turn_deg = 0;                      ///< of the surroundings about the vertical
  std::optional<Eigen::Vector3d> to_light;  ///< unit
};

/// "azimuth,elevation" in degrees (from the x axis towards y, and above the platform), or "x,y,z";
/// several with semicolons between them. Unit vectors. Throws Error, --light in front, for anything
/// else, an elevation beyond 90 degrees or a vector without length.
std::vector<Eigen::Vector3d> ParseLightDirections(const std::string& text);

/// The light of `frames` frames: the surroundings make a full turn from `turn_deg` on; the light
/// goes from the first of its directions to the last along great circles at even speed, and makes a
/// full turn about the vertical where there is one only. A film of one frame is its beginning.
std::vector<FrameLight> PlanLights(double turn_deg, const std::vector<Eigen::Vector3d>& to_light,
                                   int frames);

}  // namespace lfm
