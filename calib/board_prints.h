// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "calib/board.h"
#include "calib/board_sheets.h"

namespace lfm {

/// Writes everything that a board is printed and looked at from into `folder`: `board.json`,
/// `board.pdf` (all sheets of all plates), `board.svg` (`board-1.svg`, ... when there is more than
/// one sheet), and `board.png`, a picture `pixels_per_mm` fine (`attached-1.png`, ...: attached
/// plates). Returns the files written. Throws Error when the board is not valid, or does not fit.
std::vector<std::filesystem::path> WriteBoardPrints(const Board& board, const SheetOptions& options,
                                                    double pixels_per_mm,
                                                    const std::filesystem::path& folder);

}  // namespace lfm
