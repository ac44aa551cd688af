// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace lfm {

/// Noise of a frame's linear value I: variance = offset + slope I. Photons make the slope, reading
/// out and 8-bit levels the offset (Janesick, Photon Transfer, 2007).
struct FrameNoise {
  double offset = 1e-6, slope = 0;
  double Variance(double linear) const { return offset + slope * (linear > 0 ? linear : 0); }
};

/// A variance that was seen at a mean value, from `freedom` degrees of freedom.
struct NoiseSample {
  float mean = 0, variance = 0;
};

/// The line through the typical variance at each brightness: medians, scaled from those of
/// chi-square with `freedom` degrees of freedom to its mean, of samples sorted by brightness into
/// groups of equal size, then least squares with neither coefficient below zero. Samples that are
/// not finite are left out. Without samples, or when all frames are noise-free, what 8-bit levels
/// cause at least (1e-7).
FrameNoise FitFrameNoise(std::vector<NoiseSample> samples, int freedom);

}  // namespace lfm
