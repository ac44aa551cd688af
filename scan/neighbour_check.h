// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scan/decode.h"

namespace lfm {

/// Clears pixels that at least two of their four neighbours contradict and none confirms: decoded,
/// but more than `reach_px` projector pixels away. A wrong period moves one pixel, a surface has
/// neighbours. All are judged before any is cleared.
void RejectContradicted(int width, int height, double reach_px, AxisCoordinates& axis);

}  // namespace lfm
