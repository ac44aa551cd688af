// SPDX-License-Identifier: BSD-3-Clause
#include "calib/heldout_corners.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"

namespace lfm {
namespace {

constexpr int kMaxIterations = 12;

// The corners from `first` on in steps of `step`.
BundleView Thin(const BundleView& view, size_t first, size_t step) {
  BundleView thin = view;
  thin.points.clear(), thin.pixels.clear(), thin.corners.clear(), thin.corner_weights.clear();
  for (size_t i = first; i < view.pixels.size(); i += step) {
    if (!view.points.empty()) thin.points.push_back(view.points[i]);
    if (!view.corners.empty()) thin.corners.push_back(view.corners[i]);
    if (!view.corner_weights.empty()) thin.corner_weights.push_back(view.corner_weights[i]);
    thin.pixels.push_back(view.pixels[i]);
  }
  return thin;
}

bool SeesItsWholePicture(const Camera& camera) {
  for (const double x : {-0.5, camera.width - 0.5}) {
    for (const double y : {-0.5, camera.height - 0.5}) {
      if (!TryUnproject(camera, {x, y})) return false;
    }
  }
  return true;
}

struct ErrorSum {
  double squared_px2 = 0, weights = 0;
};

ErrorSum JudgeView(const Camera& camera, const BundleView& view, double robust_scale_px) {
  BundleView judged = Thin(view, 1, 2);
  judged.camera_from_world = AdjustPose(camera, Thin(view, 0, 2), robust_scale_px);
  ErrorSum sum;
  const double most = robust_scale_px * robust_scale_px;
  const auto errors = ReprojectionErrors(camera, judged);
  for (size_t i = 0; i < errors.size(); ++i) {
    sum.squared_px2 += errors[i] ? std::min(most, judged.SquareOf(i, *errors[i])) : most;
    sum.weights += judged.WeightOf(i).trace() / 2;
  }
  return sum;
}

ErrorSum JudgePart(const JointBundle& bundle, size_t part, double robust_scale_px,
                   FoldingLens folding) {
  JointBundle fitted{bundle.cameras, {}, bundle.platform};
  for (size_t i = 0; i < bundle.views.size(); ++i) {
    if (i % kHeldoutParts != part) fitted.views.push_back(bundle.views[i]);
  }
  const JointResult result = AdjustJointly(fitted, robust_scale_px, kMaxIterations);
  ErrorSum sum;
  for (size_t c = 0; c < result.cameras.size(); ++c) {
    if (folding == FoldingLens::kNoModel && !SeesItsWholePicture(result.cameras[c])) {
      sum.squared_px2 = std::numeric_limits<double>::infinity();
    }
  }
  const std::vector<Eigen::Vector3d> positions =
      bundle.platform ? CornerPositions(bundle.platform->printed, result.shape)
                      : std::vector<Eigen::Vector3d>();
  for (size_t i = part; i < bundle.views.size(); i += kHeldoutParts) {
    BundleView view = bundle.views[i];
    if (bundle.platform) {
      view.points.clear();
      for (const int corner : view.corners) view.points.push_back(positions[corner]);
    }
    const ErrorSum of_view = JudgeView(result.cameras[view.camera], view, robust_scale_px);
    sum.squared_px2 += of_view.squared_px2;
    sum.weights += of_view.weights;
  }
  return sum;
}

}  // namespace

JointBundle SpreadBundle(const JointBundle& bundle, size_t most_views, size_t most_corners) {
  JointBundle some{bundle.cameras, {}, bundle.platform};
  std::vector<size_t> usable;
  for (size_t i = 0; i < bundle.views.size(); ++i) {
    if (bundle.views[i].pixels.size() >= kHeldoutLeastCorners) usable.push_back(i);
  }
  const size_t count = std::min(usable.size(), most_views);
  for (size_t i = 0; i < count; ++i) {
    const BundleView& view = bundle.views[usable[i * usable.size() / count]];
    const size_t step = (view.pixels.size() + most_corners - 1) / most_corners;
    some.views.push_back(Thin(view, 0, std::max<size_t>(1, step)));
  }
  return some;
}

double HeldoutRms(const JointBundle& bundle, double robust_scale_px, FoldingLens folding) {
  std::array<ErrorSum, kHeldoutParts> sums;
  ParallelFor(0, kHeldoutParts, [&](int64_t part) {
    sums[part] = JudgePart(bundle, static_cast<size_t>(part), robust_scale_px, folding);
  });
  ErrorSum total;
  for (const ErrorSum& sum : sums) {
    total.squared_px2 += sum.squared_px2;
    total.weights += sum.weights;
  }
  return total.weights > 0 ? std::sqrt(total.squared_px2 / total.weights) : 0;
}

}  // namespace lfm
