// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace lfm {

/// What a pixel of a scan shows, for telling which neighbours are lit alike.
struct ScanGuide {
  /// Means over the pixel, world frame; the normal is unit where the pixel is `whole`.
  Eigen::Vector3f point = {0, 0, 0}, normal = {0, 0, 0};
  float albedo = 0;    ///< mean
  bool whole = false;  ///< every sample shows one surface that gathers bounced light
};

/// Rows of all frames of a scan, linear, light that comes straight apart from light that bounced.
struct ScanBand {
  ScanBand(int width_in, int first_row_in, int rows_in, int frames_in);

  float* Direct(int x, int y) { return &direct[Offset(x, y)]; }
  float* Bounce(int x, int y) { return &bounce[Offset(x, y)]; }
  ScanGuide& Guide(int x, int y) { return guides[Pixel(x, y)]; }

  size_t Pixel(int x, int y) const {
    return static_cast<size_t>(y - first_row) * static_cast<size_t>(width) + static_cast<size_t>(x);
  }
  size_t Offset(int x, int y) const { return Pixel(x, y) * static_cast<size_t>(frames); }

  /// Takes over the rows that `other` has as well.
  void CopyRows(const ScanBand& other);

  int width = 0, first_row = 0, rows = 0, frames = 0;
  std::vector<float> direct, bounce;  ///< a pixel's frames side by side
  std::vector<ScanGuide> guides;
};

/// Neighbours on either side whose bounced light is averaged.
inline constexpr int kBounceReach = 2;

/// The frames of pixel (x, y): direct light plus bounced light. The latter is noisy and smooth over
/// a surface, so the irradiance (bounced light over albedo) is the mean of those of the up to 25
/// pixels round about that lie in the band, show nothing else and lie on the same smooth surface:
/// normals within 25 degrees, and less than a millimetre and a fifth of the way off the pixel's
/// tangent plane. A pixel that shows an edge keeps what it gathered itself. `out` has `frames`
/// values.
void AddFilteredBounce(const ScanBand& band, int x, int y, float* out);

}  // namespace lfm
