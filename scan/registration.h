// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/camera.h"
#include "core/progress.h"
#include "scan/consensus.h"
#include "scan/turntable.h"

namespace lfm {

/// How scans are brought together.
struct RegistrationOptions {
  int rounds = 4;                ///< correspondences are looked for anew in each
  int samples_per_scan = 1500;   ///< points of a scan that look for partners, of either half
  double max_distance_mm = 1.0;  ///< across the partner's surface
  double robust_scale = 2;       ///< of Cauchy's loss, in sigmas
  /// Of neighbouring points' errors: one sample counts as 1 / correlation independent ones.
  double correlation = 20;
};

struct Registration {
  std::vector<Pose> poses;  ///< camera_from_world, one a scan: the better ones
  RegistrationReport report;
};

/// Joint refinement of all scans' poses: generalised ICP over all overlapping pairs.
///
/// A point p_i of scan i is projected into scan j; the surface found there, of normal n_j through
/// q_j, is its partner (Blais and Levine 1995). The residual
///   n_j . (P_j P_i^-1 p_i - q_j) / sqrt(correlation (sigma_i^2 + sigma_j^2)),   P =
///   camera_from_world
/// is that of Segal's plane-to-plane ICP (2009) for noise along the normals, under Cauchy's loss.
/// To it comes each pose's distance from its start, by its covariance: the frame stays the
/// platform's. All poses are adjusted together (Ceres), and partners looked for anew, `rounds`
/// times.
///
/// Every other block of 8 x 8 pixels is kept out of the refinement and judges it: the poses with
/// the smaller distance of held-out points are returned, so the result is never worse by that
/// measure. One scan, or scans that do not overlap, keep their poses. The result does not depend on
/// the number of threads. A common motion of world and poses moves the result alike.
///
/// `scans` stand where the platform puts them; `covariances` are of those poses, as PoseEstimate.
Registration RegisterScans(const std::vector<PosedRange>& scans,
                           const std::vector<Eigen::Matrix<double, 6, 6>>& covariances,
                           const Camera& camera, const std::vector<Eigen::Vector2d>& rays,
                           const RegistrationOptions& options, Progress& progress);

}  // namespace lfm
