// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <numbers>
#include <set>

#include "calib/board.h"
#include "calib/tag_family.h"
#include "core/error.h"
#include "core/json_reader.h"

namespace lfm {
namespace {

constexpr double kMaxSizeMm = 1e5;
constexpr int kMaxCheckerSquares = 1000;

struct Rectangle {
  Eigen::Vector2d center, x_axis, half_size;
};

double ReachAlong(const Rectangle& r, const Eigen::Vector2d& axis) {
  const Eigen::Vector2d y_axis(-r.x_axis.y(), r.x_axis.x());
  return r.half_size.x() * std::abs(r.x_axis.dot(axis)) +
         r.half_size.y() * std::abs(y_axis.dot(axis));
}

// Two convex shapes are apart exactly when a line along one of their sides separates them; grown
// rectangles keep the test conservative at corners.
bool CloserThan(const Rectangle& a, const Rectangle& b, double distance) {
  for (const Rectangle* r : {&a, &b}) {
    for (const Eigen::Vector2d& axis :
         {r->x_axis, Eigen::Vector2d(-r->x_axis.y(), r->x_axis.x())}) {
      const double gap =
          std::abs((a.center - b.center).dot(axis)) - ReachAlong(a, axis) - ReachAlong(b, axis);
      if (gap >= distance) return false;
    }
  }
  return true;
}

bool IsSize(double mm) { return mm > 0 && mm <= kMaxSizeMm; }

void ValidateSizes(const Board& board, const std::string& where) {
  if (!IsSize(board.width_mm) || !IsSize(board.height_mm)) {
    throw Error(where + ": width_mm and height_mm must be positive and at most 100000");
  }
  if (!IsSize(board.tag_size_mm)) {
    throw Error(where + ": tag_size_mm must be positive and at most 100000");
  }
  if (board.tags.empty()) {
    throw Error(where + ": tags: a board needs at least one tag to be recognised by");
  }
}

void ValidateChecker(const Board& board, const std::string& where) {
  if (board.checker_columns == 0 && board.checker_rows == 0) return;
  const auto in_range = [](int n) { return n >= 2 && n <= kMaxCheckerSquares; };
  if (!in_range(board.checker_columns) || !in_range(board.checker_rows)) {
    throw Error(where + ": checker: columns and rows must both be 0, or both 2 to 1000");
  }
  if (!IsSize(board.checker_square_mm)) {
    throw Error(where + ": checker: square_mm must be positive and at most 100000");
  }
  if (board.checker_columns * board.checker_square_mm > board.width_mm ||
      board.checker_rows * board.checker_square_mm > board.height_mm) {
    throw Error(where + ": checker: larger than the plate");
  }
}

void ValidateTag(const Board& board, const BoardTag& tag, int family_count,
                 const std::string& where) {
  if (tag.id < 0 || tag.id >= family_count) {
    throw Error(where + ": id " + std::to_string(tag.id) + " is not in " + board.family +
                " (0 to " + std::to_string(family_count - 1) + ")");
  }
  if (!tag.center_mm.allFinite() || !std::isfinite(tag.rotation) ||
      std::abs(tag.rotation) > 2 * std::numbers::pi) {
    throw Error(where + ": the centre must be finite, the rotation within one turn");
  }
}

Rectangle TagRectangle(const Board& board, const BoardTag& tag) {
  return {tag.center_mm,
          {std::cos(tag.rotation), std::sin(tag.rotation)},
          Eigen::Vector2d::Constant(board.tag_size_mm / 2)};
}

}  // namespace

void ValidateBoard(const Board& board, const std::string& where) {
  const TagFamily family(board.family, where);
  ValidateSizes(board, where);
  ValidateChecker(board, where);
  // Rounding in positions that are exactly one cell apart is no offence.
  const double quiet = board.tag_size_mm / family.cells_per_black_square() * (1 - 1e-9);
  const Rectangle checker = {{0, 0},
                             {1, 0},
                             {board.checker_columns * board.checker_square_mm / 2,
                              board.checker_rows * board.checker_square_mm / 2}};
  std::set<int> ids;
  for (size_t i = 0; i < board.tags.size(); ++i) {
    const BoardTag& tag = board.tags[i];
    const std::string place = where + ": tags[" + std::to_string(i) + "]";
    ValidateTag(board, tag, family.count(), place);
    if (!ids.insert(tag.id).second) {
      throw Error(place + ": id " + std::to_string(tag.id) + " is used twice");
    }
    const Rectangle square = TagRectangle(board, tag);
    for (const auto& [axis, extent] : {std::pair(Eigen::Vector2d(1, 0), board.width_mm),
                                       std::pair(Eigen::Vector2d(0, 1), board.height_mm)}) {
      if (std::abs(tag.center_mm.dot(axis)) + ReachAlong(square, axis) + quiet > extent / 2) {
        throw Error(place + ": closer than one cell to the plate's edge; it would not be detected");
      }
    }
    if (board.checker_columns > 0 && CloserThan(square, checker, quiet)) {
      throw Error(place + ": closer than one cell to the checker; it would not be detected");
    }
    for (size_t j = 0; j < i; ++j) {
      if (CloserThan(square, TagRectangle(board, board.tags[j]), quiet)) {
        throw Error(place + ": closer than one cell to tags[" + std::to_string(j) +
                    "]; neither would be detected");
      }
    }
  }
}

Board ReadBoard(const std::filesystem::path& file) {
  const nlohmann::json json = ReadJson(file);
  JsonReader reader(json, file.string());
  Board board;
  board.name = reader.Text("name");
  board.family = reader.Text("family");
  board.width_mm = reader.Number("width_mm");
  board.height_mm = reader.Number("height_mm");
  board.tag_size_mm = reader.Number("tag_size_mm");
  for (JsonReader& item : reader.Objects("tags")) {
    BoardTag tag;
    tag.id = item.Integer("id", 0, 1000000);
    const std::vector<double> center = item.Numbers("center_mm", 2);
    tag.center_mm = {center[0], center[1]};
    tag.rotation = item.NumberOr("rotation_deg", 0) / 180 * std::numbers::pi;
    item.Finish();
    board.tags.push_back(tag);
  }
  if (reader.Has("checker")) {
    JsonReader checker = reader.Object("checker");
    board.checker_columns = checker.Integer("columns", 2, kMaxCheckerSquares);
    board.checker_rows = checker.Integer("rows", 2, kMaxCheckerSquares);
    board.checker_square_mm = checker.Number("square_mm");
    checker.Finish();
  }
  reader.Finish();
  ValidateBoard(board, file.string());
  return board;
}

void WriteBoard(const Board& board, const std::filesystem::path& file) {
  ValidateBoard(board, board.name.empty() ? "board" : board.name);
  nlohmann::json json = {{"name", board.name},
                         {"family", board.family},
                         {"width_mm", board.width_mm},
                         {"height_mm", board.height_mm},
                         {"tag_size_mm", board.tag_size_mm},
                         {"tags", nlohmann::json::array()}};
  for (const BoardTag& tag : board.tags) {
    json["tags"].push_back({{"id", tag.id},
                            {"center_mm", {tag.center_mm.x(), tag.center_mm.y()}},
                            {"rotation_deg", tag.rotation / std::numbers::pi * 180}});
  }
  if (board.checker_columns > 0) {
    json["checker"] = {{"columns", board.checker_columns},
                       {"rows", board.checker_rows},
                       {"square_mm", board.checker_square_mm}};
  }
  WriteJson(json, file);
}

}  // namespace lfm
