// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scan/decode.h"

namespace lfm {

/// Sharpens positions where stripes are wider than what a pixel sees. Cells of `cell_px` projector
/// pixels begin at -1/2. Along the rows of the picture, or the columns if that is where positions
/// change more, an edge lies between two decoded neighbours in cells k and k +- 1, by linear
/// interpolation of their distances to it; pixels between two edges of one cell are interpolated
/// linearly. Kept where that is more certain than what the pixel itself says.
void InterpolateBetweenEdges(int width, int height, float cell_px, PatternAxis axis,
                             AxisCoordinates& coordinates);

}  // namespace lfm
