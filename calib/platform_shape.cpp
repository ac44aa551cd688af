// SPDX-License-Identifier: BSD-3-Clause
#include "calib/platform_shape.h"

#include "core/error.h"

namespace lfm {
namespace {

constexpr PlatformModel kModels[] = {
    {PlatformMoves::kNone, false},    {PlatformMoves::kNone, true},
    {PlatformMoves::kTags, false},    {PlatformMoves::kTags, true},
    {PlatformMoves::kCorners, false}, {PlatformMoves::kCorners, true}};

}  // namespace

std::vector<Eigen::Vector3d> BoardCorners(const Board& board) {
  std::vector<Eigen::Vector3d> corners;
  for (const BoardPlate& plate : PlatesOf(board)) {
    for (const BoardTag& tag : plate.board->tags) {
      for (const Eigen::Vector3d& corner : plate.board->TagCorners(tag)) {
        corners.push_back(plate.world_from_plate * corner);
      }
    }
    for (const Eigen::Vector3d& corner : plate.board->CheckerCorners()) {
      corners.push_back(plate.world_from_plate * corner);
    }
  }
  return corners;
}

std::vector<CornerPlace> PlaceCorners(const Board& board, const PlatformShape& shape) {
  return PlaceCorners(BoardCorners(board), shape);
}

std::vector<CornerPlace> PlaceCorners(const std::vector<Eigen::Vector3d>& printed,
                                      const PlatformShape& shape) {
  const bool moved = shape.shifts_mm.size() == printed.size();
  if (!moved && !shape.shifts_mm.empty()) {
    throw Error("platform shape: " + std::to_string(shape.shifts_mm.size()) +
                " shifts, but the board has " + std::to_string(printed.size()) + " corners");
  }
  const Eigen::Vector3d& b = shape.bend_per_mm;
  std::vector<CornerPlace> places;
  for (size_t i = 0; i < printed.size(); ++i) {
    const double x = printed[i].x(), y = printed[i].y();
    CornerPlace place{
        printed[i], printed[i], {2 * b.x() * x + b.y() * y, b.y() * x + 2 * b.z() * y}};
    if (moved) place.position.head<2>() += shape.shifts_mm[i];
    place.position.z() += b.x() * x * x + b.y() * x * y + b.z() * y * y;
    places.push_back(place);
  }
  return places;
}

Board MoveTags(const Board& board, const PlatformShape& shape) {
  Board moved = board;
  if (shape.shifts_mm.empty()) return moved;
  for (size_t t = 0; t < moved.tags.size(); ++t) {
    for (size_t c = 0; c < 4; ++c) moved.tags[t].center_mm += shape.shifts_mm[4 * t + c] / 4;
  }
  return moved;
}

std::vector<CornerPlace> PlaceCornersOfMovedTags(const Board& board, const PlatformShape& shape) {
  std::vector<CornerPlace> places = PlaceCorners(board, shape);
  const std::vector<Eigen::Vector3d> printed = BoardCorners(MoveTags(board, shape));
  for (size_t i = 0; i < places.size(); ++i) places[i].printed = printed[i];
  return places;
}

std::vector<Eigen::Vector3d> CornerPositions(const std::vector<Eigen::Vector3d>& printed,
                                             const PlatformShape& shape) {
  std::vector<Eigen::Vector3d> positions;
  for (const CornerPlace& place : PlaceCorners(printed, shape)) positions.push_back(place.position);
  return positions;
}

std::string PlatformModelName(const PlatformModel& model) {
  const char* moved = model.moves == PlatformMoves::kTags      ? "tags moved"
                      : model.moves == PlatformMoves::kCorners ? "corners moved"
                                                               : "";
  if (!model.bent) return *moved ? moved : "as printed";
  return *moved ? std::string(moved) + ", bent" : "bent";
}

PlatformModel PlatformModelFromName(const std::string& name) {
  for (const PlatformModel& model : kModels) {
    if (PlatformModelName(model) == name) return model;
  }
  throw Error("\"" + name + "\" is no model of a platform");
}

PlatformUnknowns MakePlatformUnknowns(const Board& board, const PlatformModel& model) {
  PlatformUnknowns unknowns;
  unknowns.printed = BoardCorners(board);
  unknowns.bent = model.bent;
  const int corners = static_cast<int>(unknowns.printed.size());
  const int of_tags = 4 * static_cast<int>(board.tags.size());
  const int of_plate = of_tags + static_cast<int>(board.CheckerCorners().size());
  for (int i = 0; i < corners; ++i) {
    int group = -1;
    if (model.moves == PlatformMoves::kCorners && i < of_plate) group = i;
    if (model.moves == PlatformMoves::kTags && i < of_tags) group = i / 4;
    unknowns.group_of_corner.push_back(group);
    unknowns.groups = std::max(unknowns.groups, group + 1);
  }
  return unknowns;
}

}  // namespace lfm
