// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/camera.h"
#include "core/pose.h"

namespace lfm {

/// The corners of one picture: `points` on the board (world, mm), seen at `pixels`.
struct BundleView {
  Pose camera_from_world;
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector2d> pixels;
};

/// Which intrinsics an adjustment may move.
enum class FreeIntrinsics {
  kFocalAndRadial,  ///< fx, fy, k1: for rough starts
  kAll,             ///< fx, fy, cx, cy and the lens terms
};

/// All lens terms, in the order in which they enter: k1, k2, p1, p2, k3.
inline constexpr int kAllLensTerms = 5;

/// The camera with only the first `count` lens terms; the others are 0.
Camera KeepLensTerms(const Camera& camera, int count);

struct BundleOptions {
  FreeIntrinsics free = FreeIntrinsics::kAll;
  int lens_terms = kAllLensTerms;  ///< of kAll: so many may move, the others are held
  double robust_scale_px = 0.5;    ///< scale s of the Cauchy loss s^2 log(1 + |r|^2 / s^2)
  int max_iterations = 100;
};

struct BundleResult {
  Camera camera;
  std::vector<Pose> poses;  ///< camera_from_world, one a view
};

/// Minimises the Cauchy loss of the reprojection errors of all views of one camera over its
/// intrinsics and all poses (Ceres; Levenberg-Marquardt on the Schur complement, one thread, so the
/// result is the same every time). A point at or behind the camera costs a large residual that
/// falls as the point comes forward. Views without corners keep their pose. Throws Error (kSystem)
/// when a start is not finite.
BundleResult AdjustBundle(const Camera& camera, const std::vector<BundleView>& views,
                          const BundleOptions& options);

/// The same for the pose of one picture, the camera held. A view without corners keeps its pose.
Pose AdjustPose(const Camera& camera, const BundleView& view, double robust_scale_px);

/// Pixel errors (measured minus projected), one a corner; no value where the point does not
/// project.
std::vector<std::optional<Eigen::Vector2d>> ReprojectionErrors(const Camera& camera,
                                                               const BundleView& view);

/// Curvature of the squared error at a solution: what covariances are made of.
struct BundleInformation {
  /// J^T J of each view's pose (rotation vector applied on the left, translation), intrinsics held.
  std::vector<Eigen::Matrix<double, 6, 6>> poses;
  /// J^T J of the intrinsics (fx, fy, cx, cy, k1, k2, p1, p2, k3) after all poses are eliminated.
  Eigen::Matrix<double, 9, 9> intrinsics = Eigen::Matrix<double, 9, 9>::Zero();
};
BundleInformation ComputeInformation(const Camera& camera, const std::vector<BundleView>& views);

/// `variance` times the inverse of a symmetric information matrix. The matrix is first scaled to a
/// unit diagonal (an unknown with none keeps its scale); directions about which the data say
/// nothing there (eigenvalues below 1e-14 of the largest) get 1e12 for their inverse eigenvalue.
/// Information that is zero throughout or not finite gives 1e12 on the diagonal, whatever
/// `variance` is.
Eigen::MatrixXd CovarianceFromInformation(const Eigen::MatrixXd& information, double variance);

}  // namespace lfm
