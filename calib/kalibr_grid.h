// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "calib/board.h"

namespace lfm {

/// The board that Kalibr's `aprilgrid.yaml` describes and its `kalibr_create_target_pdf` prints:
/// tagCols x tagRows tags tag36h11 with a black border of two cells, tagSize (metres there, mm
/// here) from edge to edge, tagSpacing x tagSize apart, a black square in every corner between and
/// beside them; ids row by row from the *lower* left, from codeOffset on. Our origin is the grid's
/// centre, theirs the lower left corner of the first tag. The plate is a tenth of a tag larger than
/// tags and squares on every side.
///
/// Throws Error on unknown or missing keys, another target type, numbers that are no numbers or out
/// of range; a tagSize above 5 m is taken for millimetres and refused with the cure.
Board ReadKalibrGrid(const std::filesystem::path& file);

/// Writes the description of a board that is such a grid (to a thousandth of a tag; squares may be
/// missing, other things not, and none may be beside). Throws Error, saying what differs, for any
/// other board.
void WriteKalibrGrid(const Board& board, const std::filesystem::path& file);

}  // namespace lfm
