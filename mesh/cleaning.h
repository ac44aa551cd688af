// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>

#include "core/point_cloud.h"

namespace lfm {

struct CleaningLimits {
  /// Points with z below this belong to the platform; below a third of it those that face sideways
  /// (more than 60 degrees from straight up), as a wall's foot does.
  double platform_margin_mm = 0.6;
  /// Points farther than this from `center` are not on the platform (a wall, a hand).
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double max_distance_mm = std::numeric_limits<double>::infinity();
};

/// The object's points, and what was taken away.
struct CleanCloud {
  PointCloud cloud;  ///< with unit normals and confidence
  int64_t platform = 0;
  int64_t outside = 0;    ///< beyond max_distance_mm, or far off compared with all others
  int64_t sparse = 0;     ///< hardly any neighbours
  int64_t detached = 0;   ///< in pieces that do not belong to the object
  double spacing_mm = 0;  ///< side of the square of surface that one point stands for
};

/// Takes away the platform, what lies outside, lone points, and pieces with less than 3 % of the
/// points of the largest piece. Missing confidence counts as 1.
///
/// Throws Error, naming `where` and saying what to check, for: an empty cloud, missing or
/// miscounted normals, coordinates that are not finite, points that are all the same, a cloud that
/// seems to be in metres (two units large at most, all of it below the margin), all points on the
/// platform, fewer than 100 points left, points that all lie in a plane or on a line.
CleanCloud CleanPoints(const PointCloud& points, const CleaningLimits& limits,
                       const std::string& where = "point cloud");

}  // namespace lfm
