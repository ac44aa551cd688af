// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calib/board.h"
#include "calib/vector_page.h"

namespace lfm {

/// Everything printed on a board's own plate as shapes, exact, in the plate's frame (mm, y up).
/// Each tag is one path along the outline of its ink, so that no reader leaves a hairline between
/// cells. Throws Error when the board is not valid.
std::vector<VectorShape> BoardInk(const Board& board);

}  // namespace lfm
