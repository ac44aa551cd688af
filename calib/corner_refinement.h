// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <vector>

#include "calib/board.h"
#include "calib/corner_template.h"
#include "calib/platform_shape.h"
#include "core/camera.h"
#include "core/image.h"
#include "core/pose.h"

namespace lfm {

/// A corner found in a picture.
struct CornerObservation {
  int corner = 0;  ///< index into PlaceCorners
  Eigen::Vector2d pixel;
  /// That its own residual suggests, px^2; not equal in all directions where the print is not.
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();

  /// Standard deviation of a coordinate, in the mean over directions.
  double SigmaPx() const { return std::sqrt(covariance.trace() / 2); }
};

struct CornerSearch {
  int window_radius_px = 8;  ///< pixels compared on each side of the corner
  double blur_px = 0;        ///< standard deviation of the picture's blur
  PixelSampling sampling = PixelSampling::kFine;
  double max_shift_px = 1.5;           ///< from the predicted place
  double max_relative_residual = 0.1;  ///< RMS of what the model leaves, over the contrast
};

/// Finds where in a picture the print round each corner fits best.
///
/// The print is rendered as the camera at `camera_from_world` would see it (exact perspective,
/// local lens, pixel area, blur), T(x); the picture is explained as
///   I(x) = (a0 + a1 x + a2 y) T(x - d) + b0 + b1 x + b2 y
/// by Gauss-Newton over d and the light a, b, in linear light, where edges are where they are
/// printed. Tag corners and checker corners (saddle points) are treated alike. Every visible corner
/// of the board is tried, whether or not its tag was detected; one is left out when it is outside
/// the picture, hidden, shadowed or blurred so that the model leaves too much, when its shift is
/// not determined to a quarter pixel, or moves farther than `max_shift_px`. Saturated pixels are
/// not data.
///
/// `linear_gray`: one float channel, linear (else Error, kSystem). Non-finite pixels are not data.
std::vector<CornerObservation> FindCorners(const Image& linear_gray, const BoardPrint& print,
                                           const std::vector<CornerPlace>& corners,
                                           const Camera& camera, const Pose& camera_from_world,
                                           const CornerSearch& search);

/// The blur (standard deviation, px, 0 to 4; by golden section next to the best of ten) under which
/// at most 20 corners, evenly chosen among `observed`, fit best; 0 when there are none.
double EstimateBlur(const Image& linear_gray, const BoardPrint& print,
                    const std::vector<CornerPlace>& corners, const Camera& camera,
                    const Pose& camera_from_world, const std::vector<CornerObservation>& observed,
                    const CornerSearch& search);

/// The linear luminance that FindCorners works on.
Image LinearGray(const Image& picture);

/// The same picture blurred by a Gaussian of `sigma_px` > 0: searched with the template blurred
/// alike (`CornerSearch::blur_px`), corners are found from farther away. Borders are repeated.
Image BlurGray(const Image& linear_gray, double sigma_px);

}  // namespace lfm
