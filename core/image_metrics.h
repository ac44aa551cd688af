// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/image.h"

namespace lfm {

/// Differences of two 8-bit sRGB pictures over the pixels of a mask, all channels together.
struct ImageDifference {
  int64_t pixels = 0;  ///< pixels in the mask
  double mse = 0;      ///< mean squared difference, levels^2
  double psnr_db = 0;  ///< 10 log10(255^2 / mse); 99 when the pictures agree exactly
  double ape = 0;      ///< mean absolute difference, levels (the paper's average pixel error)
  double ssim = 0;     ///< mean SSIM (Wang 2004; Gaussian window 11x11, sigma 1.5, luminance)
};

/// PSNR of a mean squared error in levels^2; 99 dB is the ceiling. Throws Error unless `mse` is
/// finite and not negative.
double PsnrFromMse(double mse);

/// Compares `image` with `reference`, both 8-bit RGB of one size, where `mask` (8 bit, one channel)
/// is at least 128. SSIM is averaged over windows centred on mask pixels; pixels outside the mask
/// take the reference's value in both pictures first, so that backgrounds do not count. A window
/// that leaves the picture is cut off and its weights renormalised.
/// Throws Error when sizes or types differ, or the mask is empty.
ImageDifference CompareImages(const Image& image, const Image& reference, const Image& mask);

}  // namespace lfm
