// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calib/board.h"
#include "calib/vector_page.h"
#include "core/options.h"

namespace lfm {

enum class Paper { kAuto, kA4, kA3, kA2, kA1, kA0, kLetter, kTabloid, kCustom };

/// What a board is printed on.
struct SheetOptions {
  Paper paper = Paper::kAuto;
  double paper_width_mm = 300, paper_height_mm = 300;
  double margin_mm = 8;
  double overlap_mm = 10;

  void Declare(OptionVisitor& v) {
    v.Enumeration(
        {"paper",
         "Sheet to print on; auto: the smallest of A4 to A0 that holds the board. A board "
         "that is larger goes over several sheets."},
        {"auto", "a4", "a3", "a2", "a1", "a0", "letter", "tabloid", "custom"}, paper);
    v.Number({"paper-width", "Width of --paper custom.", "mm", 40, 5000}, paper_width_mm);
    v.Number({"paper-height", "Height of --paper custom.", "mm", 40, 5000}, paper_height_mm);
    v.Number({"margin", "Border of the sheet that the printer leaves white.", "mm", 0, 100},
             margin_mm);
    v.Number({"overlap", "What neighbouring sheets of a large board both show.", "mm", 0, 100},
             overlap_mm);
  }
};

/// The pages of a board's own plate at true scale: the plate, marks to cut along outside its
/// corners, a ruler at the bottom and one at the left to measure the print with, and a line that
/// says what it is and how long the rulers must be. Sheets are turned as fits. Where the plate is
/// larger than a sheet it goes over several (row by row from the top left), each with its place,
/// and marks in the middle of the overlaps where to cut and join.
///
/// Throws Error when the margins leave less than 20 mm, or more than 400 sheets would be needed.
std::vector<VectorPage> LayOutSheets(const Board& board, const SheetOptions& options);

}  // namespace lfm
