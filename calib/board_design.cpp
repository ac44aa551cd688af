// SPDX-License-Identifier: BSD-3-Clause
#include "calib/board_design.h"

#include <algorithm>

#include "calib/circle_match.h"
#include "calib/tag_family.h"
#include "core/error.h"

namespace lfm {
namespace {

constexpr int kUsualCircles = 8, kFewestCircles = 4;
// A circle's radius and the paper it needs beyond it, in diameters.
constexpr double kCircleReach = 0.75;

void PlaceTags(const BoardDesign& design, Board& board) {
  int id = design.first_id;
  for (int row = design.tag_rows - 1; row >= 0; --row) {
    for (int column = 0; column < design.tag_columns; ++column) {
      const bool on_border =
          row == 0 || row == design.tag_rows - 1 || column == 0 || column == design.tag_columns - 1;
      if (design.layout == BoardLayout::kBorder && !on_border) continue;
      BoardTag tag;
      tag.id = id++;
      tag.center_mm = {(column - (design.tag_columns - 1) / 2.0) * design.tag_pitch_mm,
                       (row - (design.tag_rows - 1) / 2.0) * design.tag_pitch_mm};
      board.tags.push_back(tag);
    }
  }
}

// The way along the border of a rectangle, clockwise from its top left corner.
Eigen::Vector2d PointOnTrack(const Eigen::Vector2d& half, double way) {
  const double w = 2 * half.x(), h = 2 * half.y();
  if (way < w) return {-half.x() + way, half.y()};
  if (way < w + h) return {half.x(), half.y() - (way - w)};
  if (way < 2 * w + h) return {half.x() - (way - w - h), -half.y()};
  return {-half.x(), -half.y() + (way - 2 * w - h)};
}

// The middle of the strip between checker and tags, or along the plate's edge.
Eigen::Vector2d CircleTrack(const BoardDesign& design) {
  const Eigen::Vector2d plate(design.width_mm / 2, design.height_mm / 2);
  if (design.layout == BoardLayout::kCircles) {
    return plate - Eigen::Vector2d::Constant(kCircleReach * design.circle_diameter_mm);
  }
  const TagFamily family(design.family, design.border_cells, "family");
  const double tag_half = design.tag_size_mm / family.cells_per_side() * family.cells_across() / 2;
  const Eigen::Vector2d tags((design.tag_columns - 1) / 2.0 * design.tag_pitch_mm - tag_half,
                             (design.tag_rows - 1) / 2.0 * design.tag_pitch_mm - tag_half);
  const Eigen::Vector2d checker(design.checker_columns * design.checker_square_mm / 2,
                                design.checker_rows * design.checker_square_mm / 2);
  return (tags + checker) / 2;
}

// Where a quarter, half or three quarter turn of the plate lays one circle on another, they must
// differ: a checker looks the same then, and some circles are always hidden.
bool LooksLikeAfterATurn(const BoardCircle& circle, const BoardCircle& other) {
  const Eigen::Vector2d &p = circle.center_mm, &q = other.center_mm;
  for (const Eigen::Vector2d& turned :
       {Eigen::Vector2d(-p.y(), p.x()), Eigen::Vector2d(-p), Eigen::Vector2d(p.y(), -p.x())}) {
    if ((turned - q).norm() < 2 * circle.diameter_mm) return circle.color == other.color;
  }
  return false;
}

CircleColor ChooseColor(const std::vector<BoardCircle>& before, BoardCircle circle) {
  for (int c = 0; c < kCircleColors; ++c) {
    circle.color = static_cast<CircleColor>((static_cast<int>(before.size()) + c) % kCircleColors);
    const bool taken = std::any_of(before.begin(), before.end(), [&](const BoardCircle& other) {
      return LooksLikeAfterATurn(circle, other);
    });
    if (!taken) break;
  }
  return circle.color;
}

void PlaceCircles(const BoardDesign& design, Board& board) {
  const int count = design.circles > 0                       ? design.circles
                    : design.layout == BoardLayout::kCircles ? kUsualCircles
                                                             : 0;
  if (count == 0) return;
  if (count < kFewestCircles) {
    throw Error("circles: " + std::to_string(count) + "; a platform is found by four or more");
  }
  const Eigen::Vector2d half = CircleTrack(design);
  if (!(half.minCoeff() > 0)) {
    throw Error("circle-diameter: " + std::to_string(design.circle_diameter_mm) +
                " mm leaves no room for circles on this board");
  }
  const double length = 4 * half.sum();
  for (int i = 0; i < count; ++i) {
    BoardCircle circle;
    circle.center_mm = PointOnTrack(half, length * i / count);
    circle.diameter_mm = design.circle_diameter_mm;
    circle.color = ChooseColor(board.circles, circle);
    board.circles.push_back(circle);
  }
  // Another one at the end breaks what symmetry is left.
  for (int c = 0; c < kCircleColors && CirclesAreAmbiguous(board.circles); ++c) {
    board.circles.back().color = static_cast<CircleColor>(c);
  }
}

}  // namespace

Board DesignBoard(const BoardDesign& design) {
  BoardDesign checked = design;
  ValidateOptions(AnyOptions(checked));
  if (!std::all_of(design.name.begin(), design.name.end(),
                   [](char c) { return c >= ' ' && c <= '~'; })) {
    throw Error("name: has signs that cannot be printed beside the board; use ASCII letters");
  }
  Board board;
  board.name = design.name;
  board.family = design.family;
  board.border_cells = design.border_cells;
  board.width_mm = design.width_mm;
  board.height_mm = design.height_mm;
  if (design.layout != BoardLayout::kCircles) {
    board.tag_size_mm = design.tag_size_mm;
    PlaceTags(design, board);
  }
  if (design.layout != BoardLayout::kGrid) {
    board.checker_columns = design.checker_columns;
    board.checker_rows = design.checker_rows;
    board.checker_square_mm =
        design.checker_columns > 0 || design.checker_rows > 0 ? design.checker_square_mm : 0;
    PlaceCircles(design, board);
  } else if (design.circles > 0) {
    throw Error("circles: the layout grid has no room for them; use border or circles");
  }
  ValidateBoard(board, "board design");
  return board;
}

Board DefaultBoard() { return DesignBoard({}); }

}  // namespace lfm
