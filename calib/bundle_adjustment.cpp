// SPDX-License-Identifier: BSD-3-Clause
#include "calib/bundle_adjustment.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "calib/bundle_system.h"
#include "core/error.h"

namespace lfm {
namespace {

constexpr double kFirstDamping = 1e-4, kLeastDamping = 1e-12, kMostDamping = 1e8;
constexpr double kConverged_rel = 1e-10;

using PoseStep = Eigen::Matrix<double, 6, 1>;

void CheckStart(const JointBundle& bundle) {
  bool finite = true;
  for (const BundleCamera& camera : bundle.cameras) {
    finite = finite && PackIntrinsics(camera.camera).allFinite();
  }
  for (const BundleView& view : bundle.views) {
    finite = finite && view.camera_from_world.rotation.allFinite() &&
             view.camera_from_world.translation.allFinite() && std::isfinite(view.weight);
    for (const Eigen::Matrix2d& w : view.corner_weights) finite = finite && w.allFinite();
    for (const Eigen::Vector3d& p : view.points) finite = finite && p.allFinite();
    for (const Eigen::Vector2d& p : view.pixels) finite = finite && p.allFinite();
    if (bundle.platform && view.corners.size() != view.pixels.size()) {
      throw Error("bundle adjustment: views do not name their corners", ErrorKind::kSystem);
    }
  }
  if (!finite) throw Error("bundle adjustment: the start is not finite", ErrorKind::kSystem);
}

struct Step {
  Eigen::VectorXd shared;
  std::vector<PoseStep> poses;
  double decrease = 0;  ///< of half the cost, predicted to first order
  bool finite = true;
};

Step SolveStep(const BundleSystem& system, double damping) {
  ReducedSystem reduced = EliminatePoses(system, damping);
  Step step;
  const Eigen::Index n = reduced.gradient.size();
  // Unknowns that no corner touches stay where they are.
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!(system.shared(i, i) > 0)) reduced.information(i, i) = 1;
  }
  step.shared.resize(n);
  if (n > 0) {
    // Many times as fast as the pivoting one, which is for what is not positive definite.
    const Eigen::LLT<Eigen::MatrixXd> quick(reduced.information);
    step.shared = quick.info() == Eigen::Success
                      ? Eigen::VectorXd(-quick.solve(reduced.gradient))
                      : Eigen::VectorXd(-reduced.information.ldlt().solve(reduced.gradient));
  }
  step.decrease = -system.gradient.dot(step.shared);
  step.finite = step.shared.allFinite();
  for (size_t v = 0; v < system.views.size(); ++v) {
    PoseStep pose = PoseStep::Zero();
    const auto& eliminated = reduced.eliminated[v];
    if (eliminated.cols() > 0) {
      pose = -eliminated.col(n) - eliminated.leftCols(n) * step.shared;
      step.decrease -= system.views[v].gradient.dot(pose);
      step.finite = step.finite && pose.allFinite();
    }
    step.poses.push_back(pose);
  }
  return step;
}

bool FiniteCameras(const BundleState& state) {
  for (const Camera& camera : state.cameras) {
    if (!PackIntrinsics(camera).allFinite() || !(camera.fx > 0) || !(camera.fy > 0)) return false;
  }
  return true;
}

}  // namespace

Camera KeepLensTerms(const Camera& camera, int count) {
  Eigen::Matrix<double, kIntrinsics, 1> values = PackIntrinsics(camera);
  values.tail(kIntrinsics - kFirstLensTerm - count).setZero();
  return UnpackIntrinsics(camera, values);
}

JointResult AdjustJointly(const JointBundle& bundle, double robust_scale_px, int max_iterations) {
  CheckStart(bundle);
  const BundleLayout layout = MakeLayout(bundle);
  BundleState state = StartState(bundle);
  double cost = BundleCost(bundle, state, robust_scale_px);
  double damping = kFirstDamping;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const BundleSystem system = Linearize(bundle, layout, state, robust_scale_px);
    bool better = false;
    double decrease = 0;
    for (; !better && damping <= kMostDamping; damping *= 10) {
      const Step step = SolveStep(system, damping);
      if (!step.finite) continue;
      if (step.decrease <= kConverged_rel * cost) break;
      BundleState moved = MoveState(bundle, layout, state, step.shared, step.poses);
      const double moved_cost = FiniteCameras(moved) ? BundleCost(bundle, moved, robust_scale_px)
                                                     : std::numeric_limits<double>::infinity();
      if (!(moved_cost < cost)) continue;
      decrease = cost - moved_cost;
      cost = moved_cost;
      state = std::move(moved);
      better = true;
    }
    if (!better) break;
    damping = std::max(kLeastDamping, damping / 100);
    if (decrease <= kConverged_rel * cost) break;
  }
  return {state.cameras, state.poses, ShapeOfState(bundle, state)};
}

BundleResult AdjustBundle(const Camera& camera, const std::vector<BundleView>& views,
                          const BundleOptions& options) {
  JointBundle bundle{{{camera, options.free, options.lens_terms}}, views};
  for (BundleView& view : bundle.views) view.camera = 0;
  JointResult result = AdjustJointly(bundle, options.robust_scale_px, options.max_iterations);
  return {result.cameras[0], std::move(result.poses)};
}

Pose AdjustPose(const Camera& camera, const BundleView& view, double robust_scale_px) {
  constexpr int kMaxIterations = 100;
  JointBundle bundle{{{camera, FreeIntrinsics::kNone, 0}}, {view}};
  bundle.views[0].camera = 0;
  return AdjustJointly(bundle, robust_scale_px, kMaxIterations).poses[0];
}

std::vector<std::optional<Eigen::Vector2d>> ReprojectionErrors(const Camera& camera,
                                                               const BundleView& view) {
  std::vector<std::optional<Eigen::Vector2d>> errors(view.points.size());
  for (size_t i = 0; i < view.points.size(); ++i) {
    const auto projected = Project(camera, view.camera_from_world * view.points[i]);
    if (projected) errors[i] = view.pixels[i] - *projected;
  }
  return errors;
}

}  // namespace lfm
