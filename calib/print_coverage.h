// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/board.h"

namespace lfm {

/// How light is gathered along one side of a pixel: a box as wide as the pixel, blurred by a
/// Gaussian. A pixel is the product of two of them.
class PixelProfile {
 public:
  /// `blur_px`: standard deviation, >= 0; below 0.001 it counts as none.
  explicit PixelProfile(double blur_px);

  double blur_px() const { return blur_px_; }
  /// Share of the light from below `x` (pixels, 0: the middle); within 1e-4.
  double ShareBelow(double x) const;
  /// The inverse, for 0 < share < 1; within 1e-9.
  double Quantile(double share) const;
  /// The same from a table: within 2e-3 px for blurs up to 0.5 px, the outermost hundredths of the
  /// light aside.
  double RoughQuantile(double share) const;

 private:
  double blur_px_, reach_;
  std::vector<double> shares_, quantiles_;
};

/// Share of a pixel's light from where row . o < distance, o the offset in pixels: closed form.
double ShareBehindLine(const PixelProfile& profile, const Eigen::Vector2d& row, double distance);

/// Where the plate's points lie round the one in a pixel's middle: at the offset o (px)
///   mm_per_px o / (1 + nearing . o).
struct PlateSlope {
  Eigen::Matrix2d mm_per_px;
  Eigen::Vector2d nearing = {0, 0};  ///< relative change of the reciprocal depth, 1/px
};

/// Mean value that a pixel sees of a print as `cross` says it is all round: exact without blur or
/// where one line passes, within 0.003 (RMS; 0.015 at most) where two do. Lines are straight in the
/// picture, too: perspective takes nothing from that.
double PixelOfCross(const PrintCross& cross, const PlateSlope& slope, const PixelProfile& profile);

}  // namespace lfm
