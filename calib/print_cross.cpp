// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "calib/board.h"

namespace lfm {

// Square cells of ink and paper, with nothing but paper round them.
struct BoardPrint::InkGrid {
  Eigen::Vector2d corner_mm;  // of cell (0, 0)
  Eigen::Vector2d x_axis;
  double cell_mm = 0;
  int columns = 0, rows = 0;
  const PlacedTag* tag = nullptr;  // whose cells, from the top row; else a checker

  Eigen::Vector2d Place(const Eigen::Vector2d& point_mm) const {
    const Eigen::Vector2d d = point_mm - corner_mm;
    return Eigen::Vector2d(d.dot(x_axis), d.y() * x_axis.x() - d.x() * x_axis.y()) / cell_mm;
  }
  bool Near(const Eigen::Vector2d& point_mm, double reach_mm) const {
    const Eigen::Vector2d place = Place(point_mm);
    const double reach = reach_mm / cell_mm;
    return place.x() > -reach && place.y() > -reach && place.x() < columns + reach &&
           place.y() < rows + reach;
  }
  double Value(int column, int row) const {
    if (column < 0 || row < 0 || column >= columns || row >= rows) return 1;
    if (tag == nullptr) return (column + row) % 2 == 0 ? 0 : 1;
    return tag->cells[static_cast<size_t>(rows - 1 - row) * columns + column];
  }
};

std::optional<BoardPrint::InkGrid> BoardPrint::OnlyGridNear(const Eigen::Vector2d& point_mm,
                                                            double reach_mm) const {
  std::optional<InkGrid> found;
  int near = 0;
  const auto consider = [&](const InkGrid& grid) {
    if (!grid.Near(point_mm, reach_mm)) return;
    ++near;
    found = grid;
  };
  const size_t cell = GridCell(point_mm);
  for (int i = grid_offsets_[cell]; i < grid_offsets_[cell + 1]; ++i) {
    const PlacedTag& tag = tags_[grid_tags_[i]];
    const Eigen::Vector2d y_axis(-tag.x_axis.y(), tag.x_axis.x());
    consider({tag.center_mm - tag_half_mm_ * (tag.x_axis + y_axis), tag.x_axis, cell_mm_,
              cells_across_, cells_across_, &tag});
  }
  for (const BoardSquare& s : board_.squares) {
    consider({s.center_mm - Eigen::Vector2d::Constant(s.size_mm / 2), {1, 0}, s.size_mm, 1, 1});
  }
  if (board_.checker_columns > 0) {
    const double square = board_.checker_square_mm;
    consider({-square / 2 * Eigen::Vector2d(board_.checker_columns, board_.checker_rows),
              {1, 0},
              square,
              board_.checker_columns,
              board_.checker_rows});
  }
  if (near != 1) found.reset();
  return found;
}

std::optional<PrintCross> BoardPrint::CrossNear(const Eigen::Vector2d& point_mm,
                                                double reach_mm) const {
  const Eigen::Array2d to_edge =
      Eigen::Array2d(board_.width_mm, board_.height_mm) / 2 - point_mm.array().abs();
  // Written so that NaN is refused.
  const bool listed = tags_.empty() || reach_mm <= listed_mm_;
  if (!(to_edge.minCoeff() > reach_mm && listed)) return std::nullopt;
  if (CircleAt(point_mm, reach_mm) != nullptr) return std::nullopt;
  const std::optional<InkGrid> grid = OnlyGridNear(point_mm, reach_mm);
  if (!grid) return std::nullopt;
  const Eigen::Vector2d place = grid->Place(point_mm);
  const Eigen::Vector2d line(std::round(place.x()), std::round(place.y()));
  const Eigen::Vector2d offset = (line - place) * grid->cell_mm;
  // The next line is a cell further, on the other side.
  if (offset.cwiseAbs().maxCoeff() + reach_mm >= grid->cell_mm) return std::nullopt;
  PrintCross cross;
  cross.x_axis = grid->x_axis;
  cross.offset_mm = offset;
  const int column = static_cast<int>(line.x()), row = static_cast<int>(line.y());
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) cross.value[i][j] = grid->Value(column - 1 + i, row - 1 + j);
  }
  return cross;
}

}  // namespace lfm
