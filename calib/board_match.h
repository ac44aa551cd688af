// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <variant>
#include <vector>

#include "calib/board.h"
#include "calib/tag_detection.h"

namespace lfm {

/// The tags of a picture that agree with one view of the board.
struct BoardMatch {
  int tags = 0;                            ///< that agree
  std::vector<Eigen::Vector2d> points_mm;  ///< corners on the board (z = 0), four a tag
  std::vector<Eigen::Vector2d> pixels;     ///< where the detector saw them
  Eigen::Matrix3d pixel_from_board;        ///< homography through all of them (no lens)
};

/// Why a picture does not show the board: one line for people.
struct BoardMismatch {
  std::string reason;
};

/// Finds the largest set of detections that one homography of the board explains to within a
/// third of a tag (room for lens distortion), tried from pairs of tags. Detections of ids that
/// the board does not have are passed over; so are further copies of a tag elsewhere in the picture
/// (a reflection, another print), as long as they are the smaller part.
///
/// Mismatch when there is no tag, none of the board's, or fewer than two thirds of the board's
/// tags that are seen agree (two boards in one picture, or another layout with the same ids).
std::variant<BoardMatch, BoardMismatch> MatchBoard(const Board& board,
                                                   const std::vector<TagDetection>& detections);

}  // namespace lfm
