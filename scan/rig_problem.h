// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/ceres.h>

#include <array>
#include <memory>
#include <vector>

#include "scan/pose_parameters.h"
#include "scan/rig_adjustment.h"
#include "scan/turntable_residual.h"

namespace lfm {

/// A Ceres problem over the unknowns of a rig, and the parameter blocks that it works on. Blocks
/// that nothing depends on are not in the problem.
struct RigProblem {
  std::array<double, 12> camera;        ///< fx fy cx cy k1 k2 p1 p2 k3 k4 k5 k6
  std::array<double, 4> pinhole, lens;  ///< fx fy cx cy; k1 k2 p1 p2
  std::array<double, 3> turn = {0, 0, 0}, translation;
  std::vector<PoseParameters> platforms;
  std::vector<RunParameters> runs;
  ceres::Problem problem;

  /// What is free and not a pose, in the order of RigCovariance::projector.
  std::vector<double*> ProjectorBlocks() {
    return {pinhole.data(), lens.data(), turn.data(), translation.data()};
  }
};

/// Robust standard deviation of a corner's coordinate at `state` (px, 0.01 at least); 1 without
/// corners.
double CornerSigmaPx(const RigState& state, const std::vector<PlatePlacement>& placements);

/// Poses are in the problem where `data.included`. All parameters stand at `state`, whose camera
/// the correspondences' rays are of.
std::unique_ptr<RigProblem> BuildRigProblem(const RigState& state, const RigData& data,
                                            const RigFreedom& freedom,
                                            const RigCalibrationOptions& options,
                                            double corner_sigma_px);

/// The state at the problem's present parameters; `start` is what it was built from.
RigState StateOf(const RigProblem& problem, const RigState& start);

}  // namespace lfm
