// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/bundle_adjustment.h"

// The normal equations of a bundle. Private to bundle_adjustment and bundle_covariance.

namespace lfm {

/// Where a bundle's unknowns stand: every camera's free intrinsics, then the platform's unknowns.
struct BundleLayout {
  std::vector<std::vector<int>> free_intrinsics;  ///< a camera, indices into PackIntrinsics
  std::vector<int> first_intrinsic;               ///< a camera, its first unknown
  int first_shift = 0, first_bend = 0, shared = 0;
};
BundleLayout MakeLayout(const JointBundle& bundle);

struct BundleState {
  std::vector<Camera> cameras;
  std::vector<Pose> poses;
  Eigen::VectorXd platform;  ///< shifts of the groups (mm), then the bend (1/mm)
};
BundleState StartState(const JointBundle& bundle);
BundleState MoveState(const JointBundle& bundle, const BundleLayout& layout,
                      const BundleState& state, const Eigen::VectorXd& shared_step,
                      const std::vector<Eigen::Matrix<double, 6, 1>>& pose_steps);
PlatformShape ShapeOfState(const JointBundle& bundle, const BundleState& state);

/// J^T J and J^T r of half the cost, poses apart.
struct ViewSystem {
  Eigen::Matrix<double, 6, 6> pose = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, Eigen::Dynamic, 6> shared_by_pose;
};
struct BundleSystem {
  Eigen::MatrixXd shared;
  Eigen::VectorXd gradient;
  std::vector<ViewSystem> views;
};

/// `robust_scale_px` <= 0: plain squares.
BundleSystem Linearize(const JointBundle& bundle, const BundleLayout& layout,
                       const BundleState& state, double robust_scale_px);
double BundleCost(const JointBundle& bundle, const BundleState& state, double robust_scale_px);

/// The system of the shared unknowns after the poses are eliminated, every diagonal first raised by
/// `damping` of itself.
struct ReducedSystem {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
  /// A view: (damped pose block)^-1 times [pose_by_shared, gradient]; empty without corners.
  std::vector<Eigen::Matrix<double, 6, Eigen::Dynamic>> eliminated;
};
ReducedSystem EliminatePoses(const BundleSystem& system, double damping);

}  // namespace lfm
