// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/board.h"

namespace lfm {

/// The corners of a board that pictures are searched for, in the world: four a tag in the order of
/// `Board::tags` and `Board::TagCorners`, then `Board::CheckerCorners`; then those of each attached
/// board in the same way.
std::vector<Eigen::Vector3d> BoardCorners(const Board& board);

/// How the real platform departs from its file: where each corner lies, and how the plate is bent.
///
///   place = (x + dx, y + dy, z + bxx x^2 + bxy x y + byy y^2)
///
/// with (x, y, z) the corner in the file, z = 0 on the platform's own plate, and (dx, dy) its
/// shift, mm: the plate touches the world's plane z = 0 at the origin. A default one is the file's.
/// Attached boards are believed: their corners do not move, and a platform that has some is flat.
struct PlatformShape {
  std::vector<Eigen::Vector2d> shifts_mm;                 ///< one a corner of BoardCorners, or none
  Eigen::Vector3d bend_per_mm = Eigen::Vector3d::Zero();  ///< bxx, bxy, byy
};

/// Where a corner of the print lies in the world, and how the plate runs there.
struct CornerPlace {
  Eigen::Vector3d printed;         ///< on the board of the file, in the world, mm
  Eigen::Vector3d position;        ///< in the world, mm
  Eigen::Vector2d slope = {0, 0};  ///< dz/dx, dz/dy of the plate
};
std::vector<CornerPlace> PlaceCorners(const Board& board, const PlatformShape& shape);

std::vector<CornerPlace> PlaceCorners(const std::vector<Eigen::Vector3d>& printed,
                                      const PlatformShape& shape);

/// The print with every tag moved by the mean shift of its corners: what pictures show round a
/// corner, neighbours included. The board itself where nothing moved.
Board MoveTags(const Board& board, const PlatformShape& shape);
/// PlaceCorners, with `CornerPlace::printed` on the print of MoveTags.
std::vector<CornerPlace> PlaceCornersOfMovedTags(const Board& board, const PlatformShape& shape);

/// The positions of PlaceCorners alone.
std::vector<Eigen::Vector3d> CornerPositions(const std::vector<Eigen::Vector3d>& printed,
                                             const PlatformShape& shape);

/// Which departures of the platform's own plate an adjustment may find. The checker is one print:
/// where there is one, it holds the frame and tags move against it (kTags); where there is none, or
/// its corners move as well (kCorners), the prior on the shifts fixes what pictures cannot tell:
/// place, turn and scale.
enum class PlatformMoves { kNone, kTags, kCorners };
struct PlatformModel {
  PlatformMoves moves = PlatformMoves::kNone;
  bool bent = false;
};

/// "as printed", "tags moved", "corners moved, bent", ...: for people and files.
std::string PlatformModelName(const PlatformModel& model);
/// The inverse; throws Error (naming nothing: the caller knows the file) for other text.
PlatformModel PlatformModelFromName(const std::string& name);

/// The unknowns of a model in an adjustment: shifts of groups of corners, then the bend.
struct PlatformUnknowns {
  std::vector<Eigen::Vector3d> printed;  ///< BoardCorners
  std::vector<int> group_of_corner;      ///< -1: held
  int groups = 0;
  bool bent = false;
  double prior_mm = 0.3;  ///< standard deviation of a shift, a coordinate
  double noise_px = 0.1;  ///< of a corner coordinate: what the prior is weighed against

  int Count() const { return 2 * groups + (bent ? 3 : 0); }
};
PlatformUnknowns MakePlatformUnknowns(const Board& board, const PlatformModel& model);

}  // namespace lfm
