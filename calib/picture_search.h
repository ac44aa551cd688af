// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "calib/board.h"
#include "calib/bundle_adjustment.h"
#include "calib/calib.h"
#include "calib/calib_picture.h"
#include "core/capture.h"
#include "core/progress.h"

namespace lfm {

/// Loads every picture in use, notes its size and finds the board's tags (or, as `start` says,
/// circles) in it; sets aside, with the reason, what cannot be read, does not show the board, or
/// shows it mirrored. In parallel; pictures are loaded one at a time a thread and not kept.
std::vector<CalibPicture> FindBoards(std::vector<CalibPicture> pictures, const Board& board,
                                     const ImageLoader& load_image, BoardSearch start,
                                     Progress& progress);

/// How well the poses are known before a search for corners.
enum class StartQuality {
  kRough,  ///< from detected tags: within about three pixels; estimates the blur too
  kGood,   ///< from refined corners: within a pixel
};

/// Searches every picture in use of `camera_name` for the board's corners from its present pose,
/// and moves the pose to fit them with the camera held. Sets aside pictures with fewer than
/// `least_corners`. The print is looked for where `shape` puts it.
std::vector<CalibPicture> RefineCorners(std::vector<CalibPicture> pictures,
                                        const std::string& camera_name, PhotoSplit split,
                                        const Camera& camera, const Board& board,
                                        const PlatformShape& shape, const ImageLoader& load_image,
                                        StartQuality start, int least_corners,
                                        const CalibOptions& options, Progress& progress);

/// The refined corners of a picture as the adjustment takes them; `positions` of all corners. Each
/// weighs by the covariance that its own fit suggests (no less than a quarter of the median), in
/// the mean 1: those that an object half hides, or that are seen small, say less.
BundleView ViewOfCorners(const CalibPicture& picture,
                         const std::vector<Eigen::Vector3d>& positions);

}  // namespace lfm
