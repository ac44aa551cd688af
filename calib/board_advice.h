// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calib/board.h"

namespace lfm {

/// What a valid board will be bad at when a camera sees it `mm_per_pixel` coarse, one line each:
/// tags whose cells cannot be read, corners that cannot be refined (nothing but other edges within
/// reach), circles too small to segment, circles without tags (gray pictures
/// tell no colours), fewer corners than a pose needs. Empty
/// when there is nothing to say. Throws Error unless mm_per_pixel is positive and finite.
std::vector<std::string> AdviseOnBoard(const Board& board, double mm_per_pixel);

}  // namespace lfm
