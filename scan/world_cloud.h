// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/board.h"
#include "core/point_cloud.h"
#include "scan/consensus.h"
#include "scan/scan.h"

namespace lfm {

/// Why a scan without points is set aside.
inline constexpr const char* kNothingAbovePlate =
    "it shows no point above the platform; is the object on it, painted matt white, and inside the "
    "view of both camera and projector?";

/// A scan's points that stand on the plate (higher than 0.4 mm and, where they face up, than three
/// of their sigmas; not beside it), in the world, in raster order. `sigma_mm` is the range map's
/// and that of the scan's pose (`covariance`, as PoseEstimate) together.
PointCloud CloudFromRange(const PosedRange& scan, const Eigen::Matrix<double, 6, 6>& covariance,
                          const std::vector<Eigen::Vector2d>& rays, const Board& board);

/// All scans' points, in order.
PointCloud Concatenate(const std::vector<ScanCloud>& scans);

}  // namespace lfm
