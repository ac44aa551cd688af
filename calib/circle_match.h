// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <variant>
#include <vector>

#include "calib/board.h"
#include "calib/board_match.h"
#include "calib/calib.h"
#include "calib/circle_detection.h"
#include "core/image.h"

namespace lfm {

/// The ellipse that a circle of the board's plane appears as under a homography (the dual conic
/// H C* H^T; Hartley and Zisserman, result 2.14). Its centre is *not* where the circle's centre
/// appears: `center_bias` is what to subtract from the ellipse's centre to get there, some
/// tenths of a pixel to pixels for a large circle seen aslant.
struct EllipseView {
  Eigen::Vector2d center = {0, 0};
  Eigen::Matrix2d shape = Eigen::Matrix2d::Identity();  ///< as DetectedCircle's
  Eigen::Vector2d center_bias = {0, 0};
};
/// Not finite, or not a positive shape, when the circle crosses the line at infinity.
EllipseView ViewCircle(const Eigen::Matrix3d& pixel_from_board, const BoardCircle& circle);

/// Finds the largest set of detections that one homography of the platform's own circles explains:
/// same colours, centres within a third of a diameter, sizes within a factor of 1.6. Pairs of
/// detections give affine hypotheses (an ellipse tells the scale along its axes, the second circle
/// the rotation); the homography of all that agree is fitted to ellipse centres less their
/// perspective bias. Detections that fit nothing are passed over. At most 20 000 pairs are tried.
///
/// Mismatch when fewer than four circles agree, or discs of another colour stand in the places of
/// more than a quarter as many. The match's points are circle centres.
std::variant<BoardMatch, BoardMismatch> MatchCircles(const Board& board,
                                                     const std::vector<DetectedCircle>& detections);

/// What to start from: `tags` (what MatchBoard made of the picture) or, as `search` says, the
/// circles seen in it. A board without circles leaves `tags` as they are.
std::variant<BoardMatch, BoardMismatch> ChooseMatch(std::variant<BoardMatch, BoardMismatch> tags,
                                                    const Board& board, const Image& picture,
                                                    BoardSearch search);

/// True when an affine motion of the plane other than standing still lays circles on circles of
/// the same colour (to half a diameter), or all lie on a line: no picture tells which way is up.
bool CirclesAreAmbiguous(const std::vector<BoardCircle>& circles);

}  // namespace lfm
