// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calib/board.h"
#include "core/options.h"

namespace lfm {

/// How a board's parts are laid out.
enum class BoardLayout {
  kBorder,   ///< tags round the border, checker inside
  kGrid,     ///< tags only, in rows and columns
  kCircles,  ///< coloured circles round the border, checker inside, no tags (Chen 2002, Figure 6)
};

/// What lfm-board makes a board from. The defaults give DefaultBoard.
struct BoardDesign {
  std::string name = "platform-220";
  BoardLayout layout = BoardLayout::kBorder;
  double width_mm = 220, height_mm = 220;
  std::string family = "tag36h11";
  double tag_size_mm = 24, tag_pitch_mm = 31;
  int tag_columns = 7, tag_rows = 7, first_id = 0;
  int border_cells = 1;
  int checker_columns = 10, checker_rows = 10;
  double checker_square_mm = 15;
  int circles = 0;
  double circle_diameter_mm = 14;

  void Declare(OptionVisitor& v) {
    v.Text({"name", "Name of the board, printed beside it."}, name);
    v.Enumeration({"layout",
                   "Tags round the border and a checker inside; tags only, in a grid; or coloured "
                   "circles round the border and a checker inside."},
                  {"border", "grid", "circles"}, layout);
    v.Number({"width", "Width of the plate.", "mm", 1, 1e5}, width_mm);
    v.Number({"height", "Height of the plate.", "mm", 1, 1e5}, height_mm);
    v.Text({"family",
            "Tag family: tag36h11, tag36h10, tag25h9, tag16h5, tagCircle21h7, tagCircle49h12, "
            "tagCustom48h12, tagStandard41h12 or tagStandard52h13."},
           family);
    v.Number({"tag-size", "Side of a tag's detected (black, or white) square.", "mm", 0.1, 1e5},
             tag_size_mm);
    v.Number({"tag-pitch", "From one tag's centre to the next.", "mm", 0.1, 1e5}, tag_pitch_mm);
    v.Integer({"tag-columns", "Tags along the width.", "", 1, 1000}, tag_columns);
    v.Integer({"tag-rows", "Tags along the height.", "", 1, 1000}, tag_rows);
    v.Integer(
        {"first-id", "Id of the first tag; several boards of one platform need different ids.", "",
         0, 1000000},
        first_id);
    v.Integer(
        {"border-cells", "Cells of a tag's black border: 1, or 2 as Kalibr prints them.", "", 1, 2},
        border_cells);
    v.Integer({"checker-columns", "Checker squares along the width; 0: none.", "", 0, 1000},
              checker_columns);
    v.Integer({"checker-rows", "Checker squares along the height; 0: none.", "", 0, 1000},
              checker_rows);
    v.Number({"checker-square", "Side of a checker square.", "mm", 0.1, 1e5}, checker_square_mm);
    v.Integer(
        {"circles",
         "Coloured circles, evenly along the plate's edge (layout circles; 0: eight), or between "
         "checker and tags (layout border).",
         "", 0, 64},
        circles);
    v.Number({"circle-diameter", "Diameter of a circle.", "mm", 0.1, 1e5}, circle_diameter_mm);
  }
};

/// The board of a design, valid (ValidateBoard). Tags are numbered row by row from the top left.
///
/// Border: `tag_columns` x `tag_rows` tags along the border of a grid, checker inside; circles in
/// the middle of the strip between them. Grid: all tags of the grid. Circles: as near to the
/// plate's edge as they may. Circles go evenly round from the top left, clockwise, in six colours;
/// as long as those suffice, no quarter or half turn of the plate lays one on another of its
/// colour.
///
/// Throws Error when an option is out of range or the parts do not fit: what lies on what.
Board DesignBoard(const BoardDesign& design);

}  // namespace lfm
