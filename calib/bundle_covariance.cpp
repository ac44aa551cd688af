// SPDX-License-Identifier: BSD-3-Clause
#include "calib/bundle_covariance.h"

#include <Eigen/Dense>
#include <cmath>

#include "calib/bundle_system.h"

namespace lfm {
namespace {

constexpr double kUnknownVariance = 1e12;

BundleState StateWithShape(const JointBundle& bundle, const PlatformShape& shape) {
  BundleState state = StartState(bundle);
  if (!bundle.platform) return state;
  const PlatformUnknowns& platform = *bundle.platform;
  for (size_t i = 0; i < shape.shifts_mm.size(); ++i) {
    const int group = platform.group_of_corner[i];
    if (group >= 0) state.platform.segment<2>(2 * group) = shape.shifts_mm[i];
  }
  if (platform.bent) state.platform.tail<3>() = shape.bend_per_mm;
  return state;
}

// Own corners, and what the shared unknowns leave open.
std::vector<Eigen::Matrix<double, 6, 6>> PoseCovariances(const BundleSystem& system,
                                                         const ReducedSystem& reduced,
                                                         const Eigen::MatrixXd& shared,
                                                         double variance) {
  std::vector<Eigen::Matrix<double, 6, 6>> covariances;
  for (size_t v = 0; v < system.views.size(); ++v) {
    Eigen::Matrix<double, 6, 6> pose = CovarianceFromInformation(system.views[v].pose, variance);
    if (shared.rows() > 0 && reduced.eliminated[v].cols() > 0) {
      const auto by_shared = reduced.eliminated[v].leftCols(shared.rows());
      pose += by_shared * shared * by_shared.transpose();
    }
    covariances.push_back((pose + pose.transpose()) / 2);
  }
  return covariances;
}

}  // namespace

BundleCovariance ComputeCovariance(const JointBundle& bundle, const PlatformShape& shape,
                                   double noise_px, const std::vector<BundleView>& followers) {
  const BundleLayout layout = MakeLayout(bundle);
  const BundleSystem system = Linearize(bundle, layout, StateWithShape(bundle, shape), 0);
  const ReducedSystem reduced = EliminatePoses(system, 0);
  const double variance = noise_px * noise_px;
  const Eigen::MatrixXd shared = layout.shared > 0
                                     ? CovarianceFromInformation(reduced.information, variance)
                                     : Eigen::MatrixXd(0, 0);
  BundleCovariance covariance;
  covariance.poses = PoseCovariances(system, reduced, shared, variance);
  if (!followers.empty()) {
    const JointBundle following{bundle.cameras, followers, bundle.platform};
    const BundleSystem own = Linearize(following, layout, StateWithShape(following, shape), 0);
    covariance.followers = PoseCovariances(own, EliminatePoses(own, 0), shared, variance);
  }
  for (size_t c = 0; c < bundle.cameras.size(); ++c) {
    Eigen::Matrix<double, kIntrinsics, kIntrinsics> of_camera;
    of_camera.setZero();
    const std::vector<int>& free = layout.free_intrinsics[c];
    for (size_t a = 0; a < free.size(); ++a) {
      for (size_t b = 0; b < free.size(); ++b) {
        of_camera(free[a], free[b]) =
            shared(layout.first_intrinsic[c] + static_cast<Eigen::Index>(a),
                   layout.first_intrinsic[c] + static_cast<Eigen::Index>(b));
      }
    }
    covariance.cameras.push_back(of_camera);
  }
  for (int i = layout.first_shift; i < layout.first_bend; i += 2) {
    covariance.shifts.push_back(shared.block<2, 2>(i, i));
  }
  return covariance;
}

Eigen::MatrixXd CovarianceFromInformation(const Eigen::MatrixXd& information, double variance) {
  const Eigen::Index n = information.rows();
  Eigen::VectorXd scale(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    scale(i) = information(i, i) > 0 ? 1 / std::sqrt(information(i, i)) : 1;
  }
  if (!information.allFinite() || information.isZero(0)) {
    return Eigen::MatrixXd::Identity(n, n) * kUnknownVariance;
  }
  const Eigen::MatrixXd unit = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(unit);
  const double floor = 1e-14 * eigen.eigenvalues()(n - 1);
  Eigen::VectorXd inverse(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double value = eigen.eigenvalues()(i);
    inverse(i) = value > floor ? 1 / value : kUnknownVariance;
  }
  const Eigen::MatrixXd unit_inverse =
      eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
  return variance * (scale.asDiagonal() * unit_inverse * scale.asDiagonal()).eval();
}

}  // namespace lfm
