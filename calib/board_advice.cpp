// SPDX-License-Identifier: BSD-3-Clause
#include "calib/board_advice.h"

#include <cmath>
#include <cstdio>

#include "calib/tag_family.h"
#include "core/error.h"

namespace lfm {
namespace {

// Seen aslant, a cell has half of this.
constexpr double kCellPx = 3;
// The window of the corner search (CornerSearch::window_radius_px) must not hold another corner.
constexpr double kCheckerPx = 9;
constexpr double kCirclePx = 20;
constexpr size_t kMinCorners = 12;

std::string Line(const std::string& plate, const char* format, double a, double b) {
  char text[200];
  std::snprintf(text, sizeof text, format, a, b);
  return plate + ": " + text;
}

void AdviseOnPlate(const Board& board, const Board& plate, double mm_per_pixel,
                   std::vector<std::string>& advice) {
  const std::string name = plate.name.empty() ? "board" : plate.name;
  if (!plate.tags.empty()) {
    const TagFamily family(board.family, board.border_cells, name);
    const double cell = plate.tag_size_mm / family.cells_per_side() / mm_per_pixel;
    if (cell < kCellPx) {
      advice.push_back(Line(name,
                            "a tag's cell is %.1f pixels wide, too few to be read aslant; make "
                            "tags %.0f mm or larger",
                            cell, std::ceil(plate.tag_size_mm * kCellPx / cell)));
    }
  }
  const double square = plate.checker_square_mm / mm_per_pixel;
  if (plate.checker_columns > 0 && square < kCheckerPx) {
    advice.push_back(Line(name,
                          "a checker square is %.1f pixels wide, so corners cannot be refined one "
                          "by one; make squares %.0f mm or larger",
                          square, std::ceil(kCheckerPx * mm_per_pixel)));
  }
  for (const BoardCircle& circle : plate.circles) {
    const double width = circle.diameter_mm / mm_per_pixel;
    if (width >= kCirclePx) continue;
    advice.push_back(Line(name,
                          "a circle is %.1f pixels wide, too few to be found aslant; make circles "
                          "%.0f mm or larger",
                          width, std::ceil(kCirclePx * mm_per_pixel)));
    break;
  }
}

}  // namespace

std::vector<std::string> AdviseOnBoard(const Board& board, double mm_per_pixel) {
  if (!(mm_per_pixel > 0 && std::isfinite(mm_per_pixel))) {
    throw Error("mm-per-pixel: must be positive");
  }
  std::vector<std::string> advice;
  size_t corners = 0, tags = 0;
  for (const BoardPlate& plate : PlatesOf(board)) {
    AdviseOnPlate(board, *plate.board, mm_per_pixel, advice);
    tags += plate.board->tags.size();
    corners += 4 * plate.board->tags.size() + plate.board->CheckerCorners().size();
  }
  if (corners < kMinCorners) {
    advice.push_back(Line(board.name.empty() ? "board" : board.name,
                          "has %.0f corners, fewer than %.0f: every picture must show all of them; "
                          "add tags or a checker",
                          static_cast<double>(corners), static_cast<double>(kMinCorners)));
  }
  if (tags == 0) {
    advice.push_back((board.name.empty() ? "board" : board.name) +
                     ": has circles and no tags: only colour pictures show where it is, not a "
                     "gray scanner's; for scans use --layout border "
                     "--circles 12 --checker-columns 8 --checker-rows 8");
  }
  if (!board.tags.empty() && board.tags.size() < 3 && board.circles.size() < 4) {
    advice.push_back(Line(board.name.empty() ? "board" : board.name,
                          "has only %.0f tag(s) on its own plate: hidden by the object, %.0f are "
                          "left; spread several round the border",
                          static_cast<double>(board.tags.size()), 0.0));
  }
  return advice;
}

}  // namespace lfm
