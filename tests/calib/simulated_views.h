// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "calib/bundle_adjustment.h"

namespace lfm {

/// What the corners of a board look like from `poses`, without any picture: views that name their
/// corners, with normal noise in each coordinate. `points` are where `board` has them, pixels where
/// they truly lie (`truth`, which may differ from the board).
std::vector<BundleView> SimulatedViews(const Camera& camera, const std::vector<Pose>& poses,
                                       const Board& board,
                                       const std::vector<Eigen::Vector3d>& truth, double noise_px,
                                       uint32_t seed);
/// The same for a platform as printed.
std::vector<BundleView> SimulatedViews(const Camera& camera, const std::vector<Pose>& poses,
                                       const Board& board, double noise_px, uint32_t seed);

/// (found - truth) as the covariances have it: rotation vector on the left, translation.
Eigen::Matrix<double, 6, 1> PoseDifference(const Pose& found, const Pose& truth);

}  // namespace lfm
