// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/image.h"

namespace lfm {

/// Rows that probes and cells (fields/light_cells.h) share: bands of equal polar angle.
constexpr int kProbeRows = 512;

/// Direction from which the light of a place in an equirectangular picture comes: `u` in [0, 1)
/// from its left edge, `v` in [0, 1] from its upper edge. The picture is what an eye in the middle
/// sees: +x in its middle (u 0.5), +y at u 0.25, -x at both edges, +z at its upper edge; azimuth =
/// 2 pi (0.5 - u), polar angle = pi v. (As sample_data/environment_light.h.)
Eigen::Vector3d ProbeDirection(double u, double v);

/// Distant light all round (a light probe), in sums that make its light in any stretch of a row a
/// matter of two lookups, exact for a picture that is constant over each pixel.
struct LightProbe {
  int columns = 0;
  /// Radiance integrated over solid angle (sr), from the left edge to each column's right edge:
  /// [row][0 to columns][channel], kProbeRows rows, RGB; 0 first.
  std::vector<double> sums;
  /// Pixels for rotations about any axis: where each lies, its solid angle, and its radiance times
  /// that.
  std::vector<Eigen::Vector3f> direction;
  std::vector<float> solid_angle;
  std::vector<Eigen::Vector3f> energy;
};

/// Of a float RGB(A), or gray, equirectangular picture of any size. More than 2048 columns are
/// averaged to as many; pixels for rotations about any axis are resampled to 512 x 256. Throws
/// Error, `name` in front, when the picture is not linear float, or a value is negative or not
/// finite.
LightProbe MakeLightProbe(const Image& picture, const std::string& name);
/// Reads a .hdr or .exr file. Throws Error also when it cannot be read, or has 8 or 16 bits.
LightProbe ReadLightProbe(const std::filesystem::path& file);

}  // namespace lfm
