// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/board.h"
#include "core/image.h"

namespace lfm {

/// A coloured disc seen in a picture.
struct DetectedCircle {
  Eigen::Vector2d center = {0, 0};  ///< of the ellipse; px, centre of the top-left pixel (0, 0)
  /// The ellipse: (p - center)^T shape^-1 (p - center) = 1; px^2.
  Eigen::Matrix2d shape = Eigen::Matrix2d::Identity();
  CircleColor color = CircleColor::kRed;
};

/// Finds discs of the six colours on white paper by colour segmentation (the "simple color
/// segmentation scheme" of Chen 2002, section 5.1).
///
/// Pixels are strongly coloured against the picture's white (the 95th percentile of each channel,
/// linear); connected ones that fill an ellipse of at least 5 px across, with paper brighter and
/// nearly uncoloured round them, are a disc. Its colour is the hue of its reflectance relative to
/// the paper beside it, so neither white balance nor shading matters. Its centre is the centroid of
/// its coverage in linear light, which blur does not move: good to about 0.1 px. Pictures are
/// averaged down to 1600 px first.
///
/// In the order of rows. Empty for gray pictures, when there is none, and when the picture is
/// black; pixels that are not finite are passed over. At most 200, the largest.
std::vector<DetectedCircle> DetectCircles(const Image& picture);

}  // namespace lfm
