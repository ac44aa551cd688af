// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calib/board.h"
#include "calib/calib.h"
#include "core/camera.h"
#include "core/image.h"

namespace lfm {

/// A picture to judge a calibration by: the photograph (8-bit sRGB RGB, dimmed) with every tag's
/// square and every checker corner drawn where the calibration says they are (blue), each corner
/// that the print is found at (green dot), and its residual as an arrow 100 times as long (orange;
/// red beyond a tenth of a pixel). Hidden corners have no dot. A scale bar says what an arrow of
/// 0.1 px looks like. Throws Error when the photograph does not have the camera's size.
Image DrawCalibration(const Image& photo, const Board& board, const Camera& camera,
                      const PlatformShape& shape, const PosedImage& image);

}  // namespace lfm
