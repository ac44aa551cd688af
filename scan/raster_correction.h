// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "scan/decode.h"
#include "scan/plate_correspondences.h"
#include "scan/rig_adjustment.h"

namespace lfm {

/// A projector shows steps, not ramps: across one of its pixels the light is constant, so a fringe
/// places what lies anywhere in the pixel at its middle. A camera pixel that spans several averages
/// this out, but not quite. Over a footprint of s_x by s_y projector pixels (the change of the
/// position from one camera pixel to the next), the position x is decoded as x + e(x),
///   e(x) = sum over k = 1, 2 of  g^(k k) (-1)^k / (pi k) sinc(k s_x) sinc(k s_y) sin(2 pi k x),
/// the Fourier series of round(x) - x, seen through the footprint's box. g is 1 for sharp pixels
/// and exp(-2 pi^2 sigma^2) for optics that blur by sigma: one number a projector, which the plate
/// tells. With 1.4 projector pixels a camera pixel, e swings by 0.07 px.
double RasterOffsetPx(double position, const Eigen::Vector2d& slope, double gain);

/// The position whose decoding gives `decoded`: e removed by fixed-point iteration. Where steps are
/// so coarse that positions cannot be told apart (|e'| >= 0.8), and for an unknown slope (zero or
/// not finite), `decoded` itself.
double RemoveRaster(double decoded, const Eigen::Vector2d& slope, double gain);

/// Change of a decoded axis by one camera pixel to the right and down, from neighbours two pixels
/// away (one, or those of one side, at the border of what is decoded). Zero where there are none,
/// or they jump.
Eigen::Vector2d SlopeAt(const AxisCoordinates& axis, int width, int height, int x, int y);

/// Removes the raster from all decoded positions of an axis, and adds to their sigmas what of it
/// may be left. Gain 0 changes nothing.
AxisCoordinates CorrectRaster(AxisCoordinates axis, int width, int height, double gain);
std::vector<PlateCorrespondence> CorrectRaster(std::vector<PlateCorrespondence> all, double gain);

/// The gain by least squares over the plate: decoded less predicted positions against e's first
/// term, columns and rows, beyond 0.5 px left out. In [0, 1.5] (sampled footprints may exceed 1); 0
/// with fewer than 200 points or when it is not significant.
double FitRasterGain(const RigState& state, const std::vector<PlateCorrespondence>& all);

}  // namespace lfm
