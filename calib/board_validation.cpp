// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <set>

#include "calib/board.h"
#include "calib/circle_match.h"
#include "calib/tag_family.h"
#include "core/error.h"

namespace lfm {
namespace {

constexpr double kMinSizeMm = 1e-3;
constexpr double kMaxSizeMm = 1e5;
// Metres for millimetres make a tag of a few hundredths: no camera could read it.
constexpr double kLeastMarkMm = 0.5;
constexpr int kMaxCheckerSquares = 1000;
constexpr size_t kMaxTags = 5000, kMaxCircles = 64, kMaxSquares = 5000, kMaxAttached = 100;
constexpr size_t kMinCircles = 4;
// Paper round a circle: what its colour is compared with.
constexpr double kCircleMarginInDiameters = 0.25;
// Rounding in positions that are exactly as far apart as they must be is no offence.
constexpr double kRounding = 1e-9;

struct Rectangle {
  Eigen::Vector2d center = {0, 0}, x_axis = {1, 0}, half_size = {0, 0};
};

double ReachAlong(const Rectangle& r, const Eigen::Vector2d& axis) {
  const Eigen::Vector2d y_axis(-r.x_axis.y(), r.x_axis.x());
  return r.half_size.x() * std::abs(r.x_axis.dot(axis)) +
         r.half_size.y() * std::abs(y_axis.dot(axis));
}

// Two convex shapes are apart exactly when a line along one of their sides separates them; grown
// rectangles keep the test conservative at corners.
bool CloserThan(const Rectangle& a, const Rectangle& b, double distance) {
  const double needed =
      distance - kRounding * (distance + a.half_size.maxCoeff() + b.half_size.maxCoeff());
  for (const Rectangle* r : {&a, &b}) {
    for (const Eigen::Vector2d& axis :
         {r->x_axis, Eigen::Vector2d(-r->x_axis.y(), r->x_axis.x())}) {
      const double gap =
          std::abs((a.center - b.center).dot(axis)) - ReachAlong(a, axis) - ReachAlong(b, axis);
      if (gap >= needed) return false;
    }
  }
  return true;
}

double DistanceTo(const Rectangle& r, const Eigen::Vector2d& point) {
  const Eigen::Vector2d d = point - r.center;
  const Eigen::Vector2d y_axis(-r.x_axis.y(), r.x_axis.x());
  const Eigen::Vector2d outside(std::max(0.0, std::abs(d.dot(r.x_axis)) - r.half_size.x()),
                                std::max(0.0, std::abs(d.dot(y_axis)) - r.half_size.y()));
  return outside.norm();
}

bool IsSize(double mm) { return mm >= kMinSizeMm && mm <= kMaxSizeMm; }

// One plate under validation.
struct PlateCheck {
  const Board& board;
  const TagFamily& family;
  std::string where;
  double cell_mm = 0, quiet_mm = 0;
  Rectangle checker;

  std::string Place(const char* kind, size_t i) const {
    return where + ": " + kind + "[" + std::to_string(i) + "]";
  }
  Rectangle TagRectangle(const BoardTag& tag) const {
    return {tag.center_mm,
            {std::cos(tag.rotation), std::sin(tag.rotation)},
            Eigen::Vector2d::Constant(cell_mm * family.cells_across() / 2)};
  }
  Rectangle SquareRectangle(const BoardSquare& square) const {
    return {square.center_mm, {1, 0}, Eigen::Vector2d::Constant(square.size_mm / 2)};
  }
  bool LeavesPlate(const Rectangle& r, double margin) const {
    const double rounding = kRounding * (margin + r.half_size.maxCoeff());
    return std::abs(r.center.x()) + ReachAlong(r, {1, 0}) + margin - rounding >
               board.width_mm / 2 ||
           std::abs(r.center.y()) + ReachAlong(r, {0, 1}) + margin - rounding > board.height_mm / 2;
  }
};

void ValidateSizes(const PlateCheck& check) {
  const Board& board = check.board;
  if (!IsSize(board.width_mm) || !IsSize(board.height_mm)) {
    throw Error(check.where + ": width_mm and height_mm must be 0.001 to 100000");
  }
  if (!board.tags.empty() && !IsSize(board.tag_size_mm)) {
    throw Error(check.where + ": tag_size_mm must be 0.001 to 100000");
  }
  if (board.tags.size() > kMaxTags || board.circles.size() > kMaxCircles ||
      board.squares.size() > kMaxSquares) {
    throw Error(check.where + ": more than 5000 tags, 64 circles or 5000 squares on one plate");
  }
}

void ValidateChecker(const PlateCheck& check) {
  const Board& board = check.board;
  if (board.checker_columns == 0 && board.checker_rows == 0) return;
  const auto in_range = [](int n) { return n >= 2 && n <= kMaxCheckerSquares; };
  if (!in_range(board.checker_columns) || !in_range(board.checker_rows)) {
    throw Error(check.where + ": checker: columns and rows must both be 0, or both 2 to 1000");
  }
  if (!IsSize(board.checker_square_mm)) {
    throw Error(check.where + ": checker: square_mm must be 0.001 to 100000");
  }
  if (board.checker_columns * board.checker_square_mm > board.width_mm ||
      board.checker_rows * board.checker_square_mm > board.height_mm) {
    throw Error(check.where + ": checker: larger than the plate; use fewer or smaller squares");
  }
}

void ValidateTagValues(const PlateCheck& check, const BoardTag& tag, const std::string& place) {
  if (tag.id < 0 || tag.id >= check.family.count()) {
    throw Error(place + ": id " + std::to_string(tag.id) + " is not in " + check.board.family +
                " (0 to " + std::to_string(check.family.count() - 1) + ")");
  }
  if (!tag.center_mm.allFinite() || !std::isfinite(tag.rotation) ||
      std::abs(tag.rotation) > 2 * std::numbers::pi) {
    throw Error(place + ": the centre must be finite, the rotation within one turn");
  }
}

void ValidateTags(const PlateCheck& check, std::set<int>& ids) {
  const Board& board = check.board;
  for (size_t i = 0; i < board.tags.size(); ++i) {
    const BoardTag& tag = board.tags[i];
    const std::string place = check.Place("tags", i);
    ValidateTagValues(check, tag, place);
    if (!ids.insert(tag.id).second) {
      throw Error(place + ": id " + std::to_string(tag.id) + " is used twice");
    }
    const Rectangle square = check.TagRectangle(tag);
    if (check.LeavesPlate(square, check.quiet_mm)) {
      throw Error(place +
                  ": closer than one cell to the plate's edge; it would not be detected (use "
                  "smaller tags or a larger plate)");
    }
    if (board.checker_columns > 0 && CloserThan(square, check.checker, check.quiet_mm)) {
      throw Error(place +
                  ": closer than one cell to the checker; it would not be detected (use "
                  "smaller tags or checker squares)");
    }
    for (size_t j = 0; j < i; ++j) {
      if (CloserThan(square, check.TagRectangle(board.tags[j]), check.quiet_mm)) {
        throw Error(place + ": closer than one cell to tags[" + std::to_string(j) +
                    "]; neither would be detected (use smaller tags, farther apart)");
      }
    }
  }
}

// A square may touch a tag's corner, but not lie in the white along its sides.
bool SpoilsTag(const PlateCheck& check, const Rectangle& square, const Rectangle& tag) {
  const Eigen::Vector2d quiet(check.quiet_mm, 0);
  Rectangle wide = tag, high = tag;
  wide.half_size += quiet;
  high.half_size += quiet.reverse();
  return CloserThan(square, wide, 0) || CloserThan(square, high, 0);
}

void ValidateSquares(const PlateCheck& check) {
  const Board& board = check.board;
  for (size_t i = 0; i < board.squares.size(); ++i) {
    const BoardSquare& square = board.squares[i];
    const std::string place = check.Place("squares", i);
    if (!square.center_mm.allFinite() || !IsSize(square.size_mm)) {
      throw Error(place + ": the centre must be finite, size_mm positive and at most 100000");
    }
    const Rectangle area = check.SquareRectangle(square);
    if (check.LeavesPlate(area, 0)) throw Error(place + ": leaves the plate");
    if (board.checker_columns > 0 && CloserThan(area, check.checker, 0)) {
      throw Error(place + ": overlaps the checker");
    }
    for (size_t j = 0; j < board.tags.size(); ++j) {
      if (SpoilsTag(check, area, check.TagRectangle(board.tags[j]))) {
        throw Error(place + ": closer than one cell to tags[" + std::to_string(j) +
                    "], which would not be detected");
      }
    }
    for (size_t j = 0; j < i; ++j) {
      if (CloserThan(area, check.SquareRectangle(board.squares[j]), 0)) {
        throw Error(place + ": overlaps squares[" + std::to_string(j) + "]");
      }
    }
  }
}

void ValidateCircles(const PlateCheck& check) {
  const Board& board = check.board;
  for (size_t i = 0; i < board.circles.size(); ++i) {
    const BoardCircle& circle = board.circles[i];
    const std::string place = check.Place("circles", i);
    if (!circle.center_mm.allFinite() || !IsSize(circle.diameter_mm)) {
      throw Error(place + ": the centre must be finite, diameter_mm positive and at most 100000");
    }
    const double margin = kCircleMarginInDiameters * circle.diameter_mm;
    const double reach = (circle.diameter_mm / 2 + margin) * (1 - kRounding);
    if (check.LeavesPlate({circle.center_mm, {1, 0}, {0, 0}}, reach)) {
      throw Error(place + ": less than a quarter of its diameter from the plate's edge");
    }
    const auto refuse = [&](const std::string& what) {
      throw Error(place + ": less than a quarter of its diameter from " + what +
                  "; make it smaller, or make room");
    };
    if (board.checker_columns > 0 && DistanceTo(check.checker, circle.center_mm) < reach) {
      refuse("the checker");
    }
    for (size_t j = 0; j < board.tags.size(); ++j) {
      const double distance = DistanceTo(check.TagRectangle(board.tags[j]), circle.center_mm);
      if (distance < std::max(reach, circle.diameter_mm / 2 + check.quiet_mm)) {
        refuse("tags[" + std::to_string(j) + "]");
      }
    }
    for (size_t j = 0; j < board.squares.size(); ++j) {
      if (DistanceTo(check.SquareRectangle(board.squares[j]), circle.center_mm) < reach) {
        refuse("squares[" + std::to_string(j) + "]");
      }
    }
    for (size_t j = 0; j < i; ++j) {
      const BoardCircle& other = board.circles[j];
      const double radii = (circle.diameter_mm + other.diameter_mm) / 2;
      const double needed =
          radii + kCircleMarginInDiameters * std::max(circle.diameter_mm, other.diameter_mm);
      if ((circle.center_mm - other.center_mm).norm() < needed * (1 - kRounding)) {
        refuse("circles[" + std::to_string(j) + "]");
      }
    }
  }
}

void ValidatePlate(const Board& board, const TagFamily& family, const std::string& where,
                   std::set<int>& ids) {
  PlateCheck check{board, family, where, 0, 0, {}};
  check.cell_mm = board.tag_size_mm / family.cells_per_side();
  check.quiet_mm = family.quiet_cells() * check.cell_mm;
  ValidateSizes(check);
  ValidateChecker(check);
  check.checker.half_size = {board.checker_columns * board.checker_square_mm / 2,
                             board.checker_rows * board.checker_square_mm / 2};
  ValidateTags(check, ids);
  ValidateSquares(check);
  ValidateCircles(check);
}

void ValidateRecognition(const Board& board, const std::string& where) {
  if (!board.tags.empty()) return;
  if (std::any_of(board.attached.begin(), board.attached.end(),
                  [](const AttachedBoard& a) { return !a.board.tags.empty(); })) {
    return;
  }
  if (board.circles.size() < kMinCircles) {
    throw Error(where +
                ": tags: a board needs at least one tag, or four circles, to be "
                "recognised by");
  }
  if (CirclesAreAmbiguous(board.circles)) {
    throw Error(where +
                ": circles: they look the same when the board is turned, or lie on a "
                "line; give them other colours, or add a tag");
  }
}

// Plates in one plane must not cover each other; elsewhere they may stand as they like.
void ValidateAttached(const Board& board, const AttachedBoard& attached, const std::string& place) {
  const Pose& pose = attached.world_from_board;
  if (attached.board.family != board.family || attached.board.border_cells != board.border_cells) {
    throw Error(place + ": family: must be the platform's");
  }
  if (!attached.board.attached.empty()) {
    throw Error(place + ": attached: nothing can be attached to an attached board");
  }
  if (attached.board.tags.empty() && attached.board.checker_columns == 0) {
    throw Error(place + ": has neither tags nor a checker, so it is of no use");
  }
  if (!pose.rotation.allFinite() || !pose.translation.allFinite() ||
      pose.translation.cwiseAbs().maxCoeff() > kMaxSizeMm) {
    throw Error(place + ": translation: must be finite and within 100000 mm");
  }
  if (!pose.rotation.isUnitary(1e-6) || pose.rotation.determinant() < 0) {
    throw Error(place + ": rotation: is no rotation");
  }
  const bool same_plane = std::abs(pose.rotation(2, 2) - 1) < kRounding &&
                          std::abs(pose.translation.z()) < kRounding * kMaxSizeMm;
  if (!same_plane) return;
  const Rectangle own = {{0, 0}, {1, 0}, {board.width_mm / 2, board.height_mm / 2}};
  const Rectangle other = {pose.translation.head<2>(),
                           pose.rotation.col(0).head<2>(),
                           {attached.board.width_mm / 2, attached.board.height_mm / 2}};
  if (CloserThan(own, other, 0)) {
    throw Error(place + ": lies in the platform's plane and covers a part of it");
  }
}

void RequireReadable(const char* marks, double size_mm, const std::string& where) {
  if (size_mm >= kLeastMarkMm) return;
  char size[64];
  std::snprintf(size, sizeof size, "%g mm", size_mm);
  throw Error(where + ": " + marks + " of " + size +
              " cannot be read by any camera; sizes given in metres? Multiply every length of the "
              "file by 1000 (a 24 mm tag is 24, not 0.024)");
}

}  // namespace

void ValidatePrint(const Board& board, const std::string& where) {
  const TagFamily family(board.family, board.border_cells, where);
  std::set<int> ids;
  ValidatePlate(board, family, where, ids);
  if (board.attached.size() > kMaxAttached) throw Error(where + ": more than 100 attached boards");
  for (size_t i = 0; i < board.attached.size(); ++i) {
    const std::string place = where + ": attached[" + std::to_string(i) + "]";
    ValidateAttached(board, board.attached[i], place);
    ValidatePlate(board.attached[i].board, family, place, ids);
  }
}

void ValidateBoard(const Board& board, const std::string& where) {
  ValidatePrint(board, where);
  ValidateRecognition(board, where);
}

void RequireReadableMarks(const Board& board, const std::string& where) {
  for (const BoardPlate& plate : PlatesOf(board)) {
    if (!plate.board->tags.empty()) {
      RequireReadable("tag_size_mm: tags", plate.board->tag_size_mm, where);
    }
    for (const BoardCircle& circle : plate.board->circles) {
      RequireReadable("circles: circles", circle.diameter_mm, where);
    }
  }
}

}  // namespace lfm
