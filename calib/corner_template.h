// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "calib/board.h"
#include "calib/platform_shape.h"
#include "calib/print_coverage.h"
#include "core/camera.h"
#include "core/pose.h"

namespace lfm {

/// Where the light of one pixel comes from: offsets (x, y; pixels) of equal weight, distributed as
/// a square pixel blurred by a Gaussian. Point-symmetric, so that a straight edge is not displaced.
struct PixelFootprint {
  PixelProfile profile;  ///< the same light, not in places
  std::vector<float> x, y;
  double reach = 0;  ///< length of the longest offset
  double tail = 0;   ///< beyond this distance no light is left to speak of
};

/// How many places of a pixel are looked at where the print is more than two crossing lines
/// (PixelOfCross answers elsewhere): 34, or 144 where less than half a pixel of blur is left. Few
/// points stand in line with a sharp edge; the steps in which they pass it look like blur, and
/// double the error of a corner in a picture without noise.
enum class PixelSampling { kCoarse, kFine };

/// `blur_px`: standard deviation of the blur, >= 0. The offsets are a Fibonacci lattice pushed
/// through the inverse of the blurred box's distribution.
PixelFootprint MakePixelFootprint(double blur_px, PixelSampling sampling = PixelSampling::kFine);

/// The board's plane as one camera sees it near one board point: the lens to third order (a linear
/// one moves corners by some thousandths of a pixel, alike in all pictures), the perspective exact.
///
///   board = board_from_pixel (d - lens_bend (dx^2, dx dy, dy^2, dx^3, dx^2 dy, dx dy^2, dy^3)),
/// d the offset to `pixel`
struct LocalView {
  Eigen::Vector2d pixel;                  ///< where the board point appears
  Eigen::Matrix3d board_from_pixel;       ///< homography to board coordinates, mm
  Eigen::Matrix<double, 2, 7> lens_bend;  ///< 1/px, 1/px^2
};

/// Near a corner the plate is its tangent plane. No answer when the point or its surroundings do
/// not appear in the picture.
std::optional<LocalView> MakeLocalView(const Camera& camera, const Pose& camera_from_world,
                                       const CornerPlace& place);

/// What one pixel sees of the print: mean reflectance (0 ink, 1 paper) over its footprint, at
/// `offset` pixels from `view.pixel`; -1 when the blur's tail reaches beyond the plate, of whose
/// surroundings nothing is known, or when the pixel looks away from the plate.
double RenderPixel(const BoardPrint& print, const LocalView& view, const PixelFootprint& footprint,
                   const Eigen::Vector2d& offset);

}  // namespace lfm
