// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "sample_data/lanes/scene_tables.h"
#include "sample_data/scene_description.h"

namespace lfm {

/// Place in an environment picture (pixel coordinates, centre of the top-left pixel = (0, 0)) where
/// a unit direction is looked up, and back. The picture is what an eye in the middle sees: azimuth
/// pi at the left edge, 0 in the middle, -pi at the right edge; +z at the upper edge.
Eigen::Vector2f EnvironmentPixel(const Eigen::Vector3f& direction, int width, int height);
Eigen::Vector3f EnvironmentDirection(const Eigen::Vector2f& pixel, int width, int height);

/// Everything infinitely far away: the dim room of Lighting and an environment map, added. The
/// picture is bilinear, wraps round sideways and is clamped at the poles.
///
/// Directions are drawn a pixel, with a probability proportional to the luminance (of both)
/// averaged over what bilinear lookup inside the pixel sees, times its solid angle; uniformly
/// within a pixel, so that `Density` is exact, and positive wherever the radiance is.
class EnvironmentLight {
 public:
  /// Throws Error when the map's picture is not float RGB, has a negative or non-finite value, or
  /// is zero everywhere, or when its gain is not positive and finite.
  EnvironmentLight(const Lighting& room, const EnvironmentMap& map);
  EnvironmentLight(const EnvironmentLight&) = delete;
  EnvironmentLight& operator=(const EnvironmentLight&) = delete;

  /// Radiance that arrives out of `direction` (unit, away from the point).
  Eigen::Vector3f Radiance(const Eigen::Vector3f& direction) const;
  /// False for a room without a map, which is too even to be worth shadow rays of its own: the
  /// paths that leave the scene find it. Draw and Density must then not be called.
  bool IsSampled() const { return !rows_.empty(); }
  bool IsBlack() const { return tables_.room_is_black && !IsSampled(); }

  struct Sample {
    Eigen::Vector3f direction, radiance;
    float density = 0;  ///< 1/sr
  };
  Sample Draw(float u1, float u2) const;
  float Density(const Eigen::Vector3f& direction) const;

  /// The same for sample_data/lanes; valid as long as this is. Lamps and directional light are not
  /// filled in.
  const LightTables& tables() const { return tables_; }

 private:
  void Tabulate(const std::vector<double>& luminance);

  std::vector<float> pixels_;   // RGB
  std::vector<float> rows_;     // cumulative, height + 1
  std::vector<float> columns_;  // cumulative a row, (width + 1) each
  std::vector<float> density_;  // 1/sr a pixel
  LightTables tables_;
};

/// A photographer's room made by the program: a soft gradient from floor to ceiling, a large square
/// softbox overhead, two upright strip lights and a cool window, a warm far wall. Radiances from
/// about 0.05 to 12. `width` x `width`/2.
EnvironmentMap MakeStudioEnvironment(int width = 256);

/// Reads an equirectangular .hdr or .exr picture. Throws Error (file, cause, cure) when it cannot
/// be read, is not a float RGB(A) picture, has a value that is negative or not finite, or is zero
/// everywhere.
EnvironmentMap ReadEnvironmentMap(const std::filesystem::path& file, float gain);

}  // namespace lfm
