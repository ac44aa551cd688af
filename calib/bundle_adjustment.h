// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/corner_projection.h"
#include "calib/platform_shape.h"
#include "core/camera.h"
#include "core/pose.h"

namespace lfm {

/// The corners of one picture: `points` on the board (world, mm), seen at `pixels`.
struct BundleView {
  Pose camera_from_world;
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector2d> pixels;
  /// Which corners of the board (BoardCorners) they are; needed where the platform is unknown.
  std::vector<int> corners = {};
  int camera = 0;     ///< index into JointBundle::cameras
  double weight = 1;  ///< of its squared errors: inverse variance over the common one
  /// Beside `weight`, one a corner: inverse covariances over the common variance. None: all 1.
  std::vector<Eigen::Matrix2d> corner_weights = {};

  Eigen::Matrix2d WeightOf(size_t i) const {
    return weight * (corner_weights.empty() ? Eigen::Matrix2d::Identity() : corner_weights[i]);
  }
  /// An error of corner `i` (px), squared and weighed.
  double SquareOf(size_t i, const Eigen::Vector2d& error) const {
    return error.dot(WeightOf(i) * error);
  }
};

/// Which intrinsics an adjustment may move.
enum class FreeIntrinsics {
  kNone,            ///< known
  kFocalAndRadial,  ///< fx, fy, k1: for rough starts
  kAll,             ///< fx, fy, cx, cy and the lens terms
};

/// All lens terms, in the order in which they enter: k1, k2, p1, p2, k3, then k4, k5, k6 together.
inline constexpr int kAllLensTerms = 8;
/// Those of Brown's model.
inline constexpr int kBrownLensTerms = 5;

/// The camera with only the first `count` lens terms; the others are 0.
Camera KeepLensTerms(const Camera& camera, int count);

struct BundleOptions {
  FreeIntrinsics free = FreeIntrinsics::kAll;
  int lens_terms = kBrownLensTerms;  ///< of kAll: so many may move, the others are held
  double robust_scale_px = 0.5;      ///< scale s of the Cauchy loss s^2 log(1 + |r|^2 / s^2)
  int max_iterations = 100;
};

struct BundleResult {
  Camera camera;
  std::vector<Pose> poses;  ///< camera_from_world, one a view
};

/// Minimises the Cauchy loss of the reprojection errors of all views of one camera over its
/// intrinsics and all poses. Views without corners keep their pose. Throws Error (kSystem) when a
/// start is not finite.
BundleResult AdjustBundle(const Camera& camera, const std::vector<BundleView>& views,
                          const BundleOptions& options);

/// The same for the pose of one picture, the camera held. A view without corners keeps its pose.
Pose AdjustPose(const Camera& camera, const BundleView& view, double robust_scale_px);

struct BundleCamera {
  Camera camera;
  FreeIntrinsics free = FreeIntrinsics::kAll;
  int lens_terms = kBrownLensTerms;
};

/// Several cameras that saw one platform, whose corners may be unknown too.
struct JointBundle {
  std::vector<BundleCamera> cameras;
  std::vector<BundleView> views;
  /// The platform's unknowns (they start as printed); without them `BundleView::points` are held.
  std::optional<PlatformUnknowns> platform = {};
};
struct JointResult {
  std::vector<Camera> cameras;
  std::vector<Pose> poses;
  PlatformShape shape;  ///< as printed when the platform was held
};

/// AdjustBundle over everything together; a shift of the platform costs (shift noise_px /
/// prior_mm)^2 px^2. Levenberg-Marquardt with reweighting; poses are eliminated view by view (Schur
/// complement), so memory grows with the views, not with the corners (5000 views take some MB), and
/// with the square of the platform's unknowns. Sums are taken in an order that does not depend on
/// the number of threads.
JointResult AdjustJointly(const JointBundle& bundle, double robust_scale_px, int max_iterations);

/// Pixel errors (measured minus projected), one a corner; no value where the point does not
/// project.
std::vector<std::optional<Eigen::Vector2d>> ReprojectionErrors(const Camera& camera,
                                                               const BundleView& view);

}  // namespace lfm
