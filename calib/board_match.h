// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <variant>
#include <vector>

#include "calib/board.h"
#include "calib/tag_detection.h"
#include "core/pose.h"

namespace lfm {

/// What a picture shows of the board, as far as it agrees with one view of it.
struct BoardMatch {
  int tags = 0;     ///< that agree, on all plates
  int circles = 0;  ///< that the match was made from; 0: it was made from tags
  /// On the plate that agrees best: corners of tags, four each, or centres of circles; and where
  /// they were seen.
  std::vector<Eigen::Vector2d> points_mm, pixels;
  Eigen::Matrix3d pixel_from_board;  ///< homography from that plate through all of them (no lens)
  Pose world_from_plate;
  /// The same and those of the other plates, in the world.
  std::vector<Eigen::Vector3d> world_points;
  std::vector<Eigen::Vector2d> world_pixels;
};

/// Why a picture does not show the board: one line for people.
struct BoardMismatch {
  std::string reason;
};

/// Finds, on each plate, the largest set of detections that one homography of the plate explains to
/// within a third of a tag (room for lens distortion), tried from pairs of tags. Detections of ids
/// that the board does not have are passed over; so are further copies of a tag elsewhere in the
/// picture (a reflection, another print), as long as they are the smaller part, and plates on which
/// too few agree.
///
/// Mismatch when there is no tag, none of the board's, or fewer than two thirds of the tags of any
/// plate that are seen agree (two boards in one picture, or another layout with the same ids).
std::variant<BoardMatch, BoardMismatch> MatchBoard(const Board& board,
                                                   const std::vector<TagDetection>& detections);

}  // namespace lfm
