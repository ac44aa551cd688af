// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace lfm {

/// Points measured on a surface, in millimetres. Optional data is empty or as long as `points`.
struct PointCloud {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> normals;  ///< unit, towards the scanner
  std::vector<float> confidence;         ///< [0, 1]
  std::vector<float> sigma_mm;           ///< standard deviation across the surface, mm, > 0
};

}  // namespace lfm
