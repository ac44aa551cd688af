// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/point_cloud.h"
#include "core/pose.h"
#include "scan/scan.h"

namespace lfm {

/// Which points of a cloud were measured from where.
struct ScanSight {
  std::vector<Eigen::Vector3d> eyes;  ///< the scanner's camera and projector, world frame
  int64_t first = 0, last = 0;        ///< points [first, last)
};

/// The sights of ScanResult::points, from where scans stand after all adjustments.
std::vector<ScanSight> SightsOf(const ScanResult& scan);

/// What scans know to be empty: the way from an eye to each point that was seen from it (a camera)
/// or lit from it (a projector).
///
/// Each eye keeps the nearest distance measured in each cell of a picture of its view, with cells
/// about as wide as its points lie apart. A place is free when, for some eye, it lies more than
/// `margin_mm` in front of the nearest point in its cell and the eight around it, of which at least
/// six hold points: at silhouettes and gaps nothing is claimed. The margin takes up the points'
/// noise and the slope of the surface within a cell.
class FreeSpace {
 public:
  /// Throws Error when a sight reaches beyond the cloud. Points that are not finite, or lie in an
  /// eye, are left out; eyes with fewer than 100 points know nothing.
  FreeSpace(const PointCloud& points, const std::vector<ScanSight>& sights, double margin_mm);

  bool IsFree(const Eigen::Vector3d& place) const;
  /// True when nothing at all is known to be free.
  bool Empty() const { return views_.empty(); }

 private:
  struct View {
    Eigen::Vector3d eye = Eigen::Vector3d::Zero();
    Eigen::Matrix3d view_from_world = Eigen::Matrix3d::Identity();
    Eigen::Vector2d low = Eigen::Vector2d::Zero();  ///< of (x / z, y / z)
    double cell = 0;
    int columns = 0, rows = 0;
    std::vector<float> nearest_mm;  ///< of a cell and the eight around; 0 = nothing is known
  };
  static View MakeView(const Eigen::Vector3d& eye, const std::vector<Eigen::Vector3d>& points);

  std::vector<View> views_;
  double margin_mm_;
};

}  // namespace lfm
