// SPDX-License-Identifier: BSD-3-Clause
#include "calib/board_ink.h"

#include <cmath>
#include <map>
#include <utility>

#include "calib/tag_family.h"

namespace lfm {
namespace {

using Vertex = std::pair<int, int>;

// The outline of the ink of a square of cells as loops over grid points; (0, 0) is the top left.
// Sides between an ink cell and anything else are directed with the ink on their right, so that at
// every point as many begin as end.
std::vector<std::vector<Vertex>> OutlineCells(const std::vector<uint8_t>& cells, int side) {
  const auto ink = [&](int column, int row) {
    const bool inside = column >= 0 && row >= 0 && column < side && row < side;
    return inside && cells[static_cast<size_t>(row) * side + column] == 0;
  };
  std::multimap<Vertex, Vertex> edges;
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      if (!ink(column, row)) continue;
      const Vertex a(column, row), b(column + 1, row), c(column + 1, row + 1), d(column, row + 1);
      if (!ink(column, row - 1)) edges.emplace(a, b);
      if (!ink(column + 1, row)) edges.emplace(b, c);
      if (!ink(column, row + 1)) edges.emplace(c, d);
      if (!ink(column - 1, row)) edges.emplace(d, a);
    }
  }
  std::vector<std::vector<Vertex>> loops;
  while (!edges.empty()) {
    std::vector<Vertex> loop;
    const Vertex start = edges.begin()->first;
    Vertex at = start;
    do {
      const auto edge = edges.find(at);
      const Vertex next = edge->second;
      edges.erase(edge);
      // Points in the middle of a straight side say nothing.
      if (loop.size() >= 2) {
        const Vertex& before = loop[loop.size() - 2];
        const Vertex& last = loop.back();
        if ((before.first == last.first && last.first == at.first) ||
            (before.second == last.second && last.second == at.second)) {
          loop.pop_back();
        }
      }
      loop.push_back(at);
      at = next;
    } while (at != start);
    // The start is a corner: it is the least of its loop's points. The last point need not be.
    const Vertex &before = loop[loop.size() - 2], &last = loop.back();
    if ((before.first == last.first && last.first == start.first) ||
        (before.second == last.second && last.second == start.second)) {
      loop.pop_back();
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

FilledPath TagInk(const Board& board, const BoardTag& tag, const TagFamily& family) {
  const int side = family.cells_across();
  const double cell = board.tag_size_mm / family.cells_per_side();
  const double c = std::cos(tag.rotation), s = std::sin(tag.rotation);
  FilledPath path;
  for (const std::vector<Vertex>& loop : OutlineCells(family.Cells(tag.id), side)) {
    std::vector<Eigen::Vector2d> points;
    for (const Vertex& v : loop) {
      const double x = (v.first - side / 2.0) * cell, y = (side / 2.0 - v.second) * cell;
      points.emplace_back(tag.center_mm.x() + c * x - s * y, tag.center_mm.y() + s * x + c * y);
    }
    path.loops.push_back(std::move(points));
  }
  return path;
}

std::vector<Eigen::Vector2d> SquareLoop(const Eigen::Vector2d& low, double size) {
  return {low, low + Eigen::Vector2d(size, 0), low + Eigen::Vector2d(size, size),
          low + Eigen::Vector2d(0, size)};
}

}  // namespace

std::vector<VectorShape> BoardInk(const Board& board) {
  ValidatePrint(board, board.name.empty() ? "board" : board.name);
  std::vector<VectorShape> shapes;
  if (!board.tags.empty()) {
    const TagFamily family(board.family, board.border_cells, board.name);
    for (const BoardTag& tag : board.tags) shapes.emplace_back(TagInk(board, tag, family));
  }
  for (int row = 0; row < board.checker_rows; ++row) {
    for (int column = row % 2; column < board.checker_columns; column += 2) {
      const Eigen::Vector2d low((column - board.checker_columns / 2.0) * board.checker_square_mm,
                                (row - board.checker_rows / 2.0) * board.checker_square_mm);
      shapes.emplace_back(FilledPath{{SquareLoop(low, board.checker_square_mm)}});
    }
  }
  for (const BoardSquare& square : board.squares) {
    const Eigen::Vector2d low = square.center_mm - Eigen::Vector2d::Constant(square.size_mm / 2);
    shapes.emplace_back(FilledPath{{SquareLoop(low, square.size_mm)}});
  }
  for (const BoardCircle& circle : board.circles) {
    const Eigen::Vector3f linear = CircleReflectance(circle.color);
    VectorColor color;
    for (int c = 0; c < 3; ++c) {
      color[c] = static_cast<uint8_t>(std::lround(255 * SrgbFromLinear(linear[c])));
    }
    shapes.emplace_back(FilledDisc{circle.center_mm, circle.diameter_mm / 2, color});
  }
  return shapes;
}

}  // namespace lfm
