// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "calib/board.h"
#include "calib/platform_shape.h"
#include "core/camera.h"
#include "core/pose.h"

namespace lfm {

/// Where the light of one pixel comes from: offsets (pixels) of equal weight, distributed as a
/// square pixel blurred by a Gaussian. Point-symmetric, so that a straight edge is not displaced.
struct PixelFootprint {
  std::vector<Eigen::Vector2d> offsets;
  double reach = 0;  ///< length of the longest offset
  double tail = 0;   ///< beyond this distance no light is left to speak of
};

/// `blur_px`: standard deviation of the blur, >= 0. The offsets are a Fibonacci lattice of 34
/// points pushed through the inverse of the blurred box's distribution.
PixelFootprint MakePixelFootprint(double blur_px);

/// The board's plane as one camera sees it near one board point: the lens linearised there, the
/// perspective exact. Good to about 0.005 px within ten pixels of a usual lens.
struct LocalView {
  Eigen::Vector2d pixel;  ///< where the board point appears
  Eigen::Matrix3d
      board_from_pixel;  ///< homography from offsets to `pixel` to board coordinates, mm
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
