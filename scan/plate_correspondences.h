// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/board.h"
#include "calib/calib.h"
#include "core/pose.h"
#include "scan/decode.h"

namespace lfm {

/// One placement of the platform in front of the rig: of the empty platform, or under a scan.
struct PlatePlacement {
  Pose camera_from_world;
  /// Of (rotation vector applied on the left, translation), rad and mm, as PosedImage has it. Holds
  /// the pose in an adjustment when there are no corners.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  std::vector<SeenCorner> corners;  ///< what the pose was found from; may be empty
};

/// A plane of the world, normal . X = height (mm): the platform's plate where a ray meets it. A
/// default one is the flat plate.
struct PlatePlane {
  Eigen::Vector3d normal = {0, 0, 1};
  double height = 0;
};

/// A point of the platform seen by the camera and lit by a known place of the projector.
struct PlateCorrespondence {
  int placement = 0;                        ///< index into the placements
  Eigen::Vector2d ray = {0, 0};             ///< (X/Z, Y/Z) of the camera's pixel, undistorted
  PlatePlane plate;                         ///< touches the plate at the point
  Eigen::Vector2d projector_px = {0, 0};    ///< decoded column and row
  Eigen::Vector2d sigma_px = {0.05, 0.05};  ///< standard deviations; row's <= 0: row unknown
  /// Change of column and row by one camera pixel to the right and down; zero: unknown.
  Eigen::Vector2d column_slope = {0, 0}, row_slope = {0, 0};
};

/// Camera-frame point where the ray (x, y, 1) meets the plane; not finite when parallel.
Eigen::Vector3d MeetPlate(const Pose& camera_from_world, const Eigen::Vector2d& ray,
                          const PlatePlane& plate);

/// The plane that touches a bent plate (PlatformShape::bend_per_mm) where the ray meets it. Where
/// it does not meet the flat plate, that plane.
PlatePlane PlateUnderRay(const Pose& camera_from_world, const Eigen::Vector2d& ray,
                         const Eigen::Vector3d& bend_per_mm);

/// Correspondences of one decoded placement, at most about `max_count`, evenly spread
/// over the camera's pixels: inside the printed plate (bent: PlatformShape::bend_per_mm), columns
/// (and rows, when there are any) decoded, paper white all round (at an ink border a pixel's light
/// does not come from its middle).
std::vector<PlateCorrespondence> PlateCorrespondences(
    const DecodedPixels& decoded, const std::vector<Eigen::Vector2d>& rays, const Board& board,
    const Eigen::Vector3d& bend_per_mm, const PlatePlacement& placement, int max_count);

/// Every n-th of a list, from the first.
template <typename T>
std::vector<T> EveryNth(const std::vector<T>& all, size_t n) {
  std::vector<T> some;
  for (size_t i = 0; i < all.size(); i += n) some.push_back(all[i]);
  return some;
}

}  // namespace lfm
