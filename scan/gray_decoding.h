// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "scan/axis_frames.h"
#include "scan/decode.h"
#include "scan/frame_planes.h"

namespace lfm {

/// How the projector lights each camera pixel, and where it is worth decoding.
struct PixelLight {
  std::vector<float> white, contrast;  ///< linear; contrast = white - black
  std::vector<uint8_t> usable;         ///< lit, finite, not saturated
};

/// Gray code alone, with or without inverses, to a fraction of a pixel.
///
/// 1. The signs of the differences pattern - inverse (2 pattern - white - black where there is no
///    inverse) are the code of a cell of 2^l projector pixels, l = 0 unless fine stripes are
///    missing or blurred away: then the finest bits that hold less than they cost are left out.
/// 2. A pixel near a cell's edge sees both sides of it. With the linear differences f and o of the
///    two bits that change at the cell's two edges, (o - f) / (o + f) goes from -1 on one edge to 1
///    on the other, exactly straight when the pixel averages over one to two cells. For any other
///    blur, how it goes is read off the picture itself: pixels lie evenly in their cells, so the
///    share of pixels with a smaller ratio is the place in the cell (histogram equalisation).
/// 3. Where cells are wider than what a pixel sees, most pixels see no edge; they are interpolated
///    between the edges found to their left and right (above and below).
/// Uncertainty: noise, fitted to the frames' own redundancy (pattern + inverse is white + black),
/// through the slope of 2, and the spread of places that look alike.
/// A pixel is rejected when a bit that should be certain is not (mixed surfaces, interreflection),
/// when the narrow stripes say that little light came straight, and when no neighbour is near it.
AxisCoordinates DecodeGrayAxis(const FramePlanes& planes, const AxisFrames& frames,
                               PatternAxis axis, int white_frame, int black_frame,
                               const PixelLight& light, const DecodeOptions& options);

}  // namespace lfm
