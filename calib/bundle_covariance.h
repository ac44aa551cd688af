// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/bundle_adjustment.h"

namespace lfm {

/// How uncertain the unknowns of a bundle are at a solution, all taken together: what is not known
/// of the intrinsics and of the platform is in the poses' covariances, and the other way round.
struct BundleCovariance {
  /// A view's pose (rotation vector applied on the left, rad; translation, mm).
  std::vector<Eigen::Matrix<double, 6, 6>> poses;
  /// A camera's intrinsics in the order of PackIntrinsics; 0 for those that are held.
  std::vector<Eigen::Matrix<double, kIntrinsics, kIntrinsics>> cameras;
  std::vector<Eigen::Matrix2d> shifts;  ///< of the platform's groups, mm^2
  /// The poses of views that follow: posed by their own corners, cameras and platform held.
  std::vector<Eigen::Matrix<double, 6, 6>> followers;
};

/// At the state that `bundle` starts from: its views' poses, its cameras, and `shape` where the
/// platform is unknown. `noise_px` is the standard deviation of a corner coordinate (of a view of
/// weight 1). Plain squares: corners that a robust loss passes over must be left out. Unknowns
/// about which the corners say nothing get variances of about 1e12.
BundleCovariance ComputeCovariance(const JointBundle& bundle, const PlatformShape& shape,
                                   double noise_px, const std::vector<BundleView>& followers = {});

/// `variance` times the inverse of a symmetric information matrix. The matrix is first scaled to a
/// unit diagonal (an unknown with none keeps its scale); directions about which the data say
/// nothing there (eigenvalues below 1e-14 of the largest) get 1e12 for their inverse eigenvalue.
/// Information that is zero throughout or not finite gives 1e12 on the diagonal, whatever
/// `variance` is.
Eigen::MatrixXd CovarianceFromInformation(const Eigen::MatrixXd& information, double variance);

}  // namespace lfm
