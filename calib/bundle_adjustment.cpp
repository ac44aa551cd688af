// SPDX-License-Identifier: BSD-3-Clause
#include "calib/bundle_adjustment.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "core/lens_distortion.h"

namespace lfm {
namespace {

constexpr int kIntrinsics = 9;
constexpr int kFirstLensTerm = 4;

// Points nearer than this in front of the camera cannot be pictures of the board.
constexpr double kMinDepthMm = 1e-3;
constexpr double kBehindCameraPx = 1e4;
constexpr double kBehindCameraPxPerMm = 10;

constexpr double kUnknownVariance = 1e12;

std::array<double, kIntrinsics> PackIntrinsics(const Camera& c) {
  return {c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3};
}

Camera UnpackIntrinsics(const Camera& frame, const std::array<double, kIntrinsics>& v) {
  Camera camera = frame;
  camera.fx = v[0], camera.fy = v[1], camera.cx = v[2], camera.cy = v[3];
  camera.k1 = v[4], camera.k2 = v[5], camera.p1 = v[6], camera.p2 = v[7], camera.k3 = v[8];
  return camera;
}

// Without the "no answer" of Project: an optimiser needs a cost everywhere.
struct CornerError {
  CornerError(const Pose& base, const Eigen::Vector3d& point, const Eigen::Vector2d& seen)
      : rotated(base.rotation * point), pixel(seen) {}

  template <typename T>
  bool operator()(const T* intrinsics, const T* pose, T* residual) const {
    const T start[3] = {T(rotated.x()), T(rotated.y()), T(rotated.z())};
    T p[3];
    ceres::AngleAxisRotatePoint(pose, start, p);
    for (int i = 0; i < 3; ++i) p[i] += pose[3 + i];
    if (p[2] < kMinDepthMm) {
      residual[0] = residual[1] = kBehindCameraPx + kBehindCameraPxPerMm * (kMinDepthMm - p[2]);
      return true;
    }
    const T x = p[0] / p[2], y = p[1] / p[2];
    const LensTerms<T> lens{intrinsics[4], intrinsics[5], intrinsics[8], intrinsics[6],
                            intrinsics[7]};
    const Eigen::Matrix<T, 2, 1> distorted = DistortNormalized(lens, x, y);
    residual[0] = intrinsics[0] * distorted[0] + intrinsics[2] - pixel.x();
    residual[1] = intrinsics[1] * distorted[1] + intrinsics[3] - pixel.y();
    return true;
  }

  Eigen::Vector3d rotated;
  Eigen::Vector2d pixel;
};

using CornerCost = ceres::AutoDiffCostFunction<CornerError, 2, kIntrinsics, 6>;

// The rotation part is a rotation vector on the left of the start's rotation: no singularity near
// the solution, and the covariance's parameters at the same time.
std::array<double, 6> PackPose(const Pose& pose) {
  return {0, 0, 0, pose.translation.x(), pose.translation.y(), pose.translation.z()};
}

Pose UnpackPose(const Pose& base, const std::array<double, 6>& v) {
  Eigen::Matrix3d turn;
  ceres::AngleAxisToRotationMatrix(v.data(), ceres::ColumnMajorAdapter3x3(turn.data()));
  const Eigen::Quaterniond rotation(Eigen::Matrix3d(turn * base.rotation));
  return Pose::FromQuaternion(rotation, {v[3], v[4], v[5]});
}

ceres::Problem::Options BorrowedLoss() {
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  return options;
}

ceres::Solver::Options SolverOptions() {
  ceres::Solver::Options options;
  options.num_threads = 1;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-10;
  options.parameter_tolerance = 1e-12;
  options.gradient_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  return options;
}

std::vector<int> HeldIntrinsics(const BundleOptions& options) {
  if (options.free == FreeIntrinsics::kFocalAndRadial) return {2, 3, 5, 6, 7, 8};
  std::vector<int> held;
  for (int i = kFirstLensTerm + options.lens_terms; i < kIntrinsics; ++i) held.push_back(i);
  return held;
}

void AddCorners(const BundleView& view, ceres::CauchyLoss& loss,
                std::array<double, kIntrinsics>& intrinsics, std::array<double, 6>& pose,
                ceres::Problem& problem) {
  for (size_t i = 0; i < view.points.size(); ++i) {
    auto* cost =
        new CornerCost(new CornerError(view.camera_from_world, view.points[i], view.pixels[i]));
    problem.AddResidualBlock(cost, &loss, intrinsics.data(), pose.data());
  }
}

void CheckStart(const Camera& camera, const std::vector<BundleView>& views) {
  bool finite = true;
  for (const double v : PackIntrinsics(camera)) finite = finite && std::isfinite(v);
  for (const BundleView& view : views) {
    finite = finite && view.camera_from_world.rotation.allFinite() &&
             view.camera_from_world.translation.allFinite();
    for (const Eigen::Vector3d& p : view.points) finite = finite && p.allFinite();
    for (const Eigen::Vector2d& p : view.pixels) finite = finite && p.allFinite();
  }
  if (!finite) throw Error("bundle adjustment: the start is not finite", ErrorKind::kSystem);
}

}  // namespace

Camera KeepLensTerms(const Camera& camera, int count) {
  std::array<double, kIntrinsics> intrinsics = PackIntrinsics(camera);
  for (int i = kFirstLensTerm + count; i < kIntrinsics; ++i) intrinsics[i] = 0;
  return UnpackIntrinsics(camera, intrinsics);
}

BundleResult AdjustBundle(const Camera& camera, const std::vector<BundleView>& views,
                          const BundleOptions& options) {
  CheckStart(camera, views);
  std::array<double, kIntrinsics> intrinsics = PackIntrinsics(camera);
  std::vector<std::array<double, 6>> poses;
  for (const BundleView& view : views) poses.push_back(PackPose(view.camera_from_world));

  ceres::CauchyLoss loss(options.robust_scale_px);
  ceres::Problem problem(BorrowedLoss());
  ceres::Solver::Options solver = SolverOptions();
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  solver.max_num_iterations = options.max_iterations;
  solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (size_t v = 0; v < views.size(); ++v) {
    if (views[v].points.empty()) continue;
    AddCorners(views[v], loss, intrinsics, poses[v], problem);
    solver.linear_solver_ordering->AddElementToGroup(poses[v].data(), 0);
  }
  if (problem.NumResidualBlocks() > 0) {
    solver.linear_solver_ordering->AddElementToGroup(intrinsics.data(), 1);
    const std::vector<int> held = HeldIntrinsics(options);
    if (!held.empty()) {
      problem.SetManifold(intrinsics.data(), new ceres::SubsetManifold(kIntrinsics, held));
    }
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
  }

  BundleResult result;
  result.camera = UnpackIntrinsics(camera, intrinsics);
  for (size_t v = 0; v < views.size(); ++v) {
    result.poses.push_back(UnpackPose(views[v].camera_from_world, poses[v]));
  }
  return result;
}

Pose AdjustPose(const Camera& camera, const BundleView& view, double robust_scale_px) {
  CheckStart(camera, {view});
  if (view.points.empty()) return view.camera_from_world;
  std::array<double, kIntrinsics> intrinsics = PackIntrinsics(camera);
  std::array<double, 6> pose = PackPose(view.camera_from_world);
  ceres::CauchyLoss loss(robust_scale_px);
  ceres::Problem problem(BorrowedLoss());
  AddCorners(view, loss, intrinsics, pose, problem);
  problem.SetParameterBlockConstant(intrinsics.data());
  ceres::Solver::Options solver = SolverOptions();
  solver.linear_solver_type = ceres::DENSE_QR;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  return UnpackPose(view.camera_from_world, pose);
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

BundleInformation ComputeInformation(const Camera& camera, const std::vector<BundleView>& views) {
  using RowMajor29 = Eigen::Matrix<double, 2, kIntrinsics, Eigen::RowMajor>;
  using RowMajor26 = Eigen::Matrix<double, 2, 6, Eigen::RowMajor>;
  const std::array<double, kIntrinsics> intrinsics = PackIntrinsics(camera);
  BundleInformation information;
  for (const BundleView& view : views) {
    Eigen::Matrix<double, 9, 9> camera_block = Eigen::Matrix<double, 9, 9>::Zero();
    Eigen::Matrix<double, 9, 6> cross = Eigen::Matrix<double, 9, 6>::Zero();
    Eigen::Matrix<double, 6, 6> pose_block = Eigen::Matrix<double, 6, 6>::Zero();
    const std::array<double, 6> pose = PackPose(view.camera_from_world);
    const double* parameters[] = {intrinsics.data(), pose.data()};
    for (size_t i = 0; i < view.points.size(); ++i) {
      const CornerCost cost(
          new CornerError(view.camera_from_world, view.points[i], view.pixels[i]));
      double residual[2];
      RowMajor29 by_camera;
      RowMajor26 by_pose;
      double* jacobians[] = {by_camera.data(), by_pose.data()};
      cost.Evaluate(parameters, residual, jacobians);
      camera_block += by_camera.transpose() * by_camera;
      cross += by_camera.transpose() * by_pose;
      pose_block += by_pose.transpose() * by_pose;
    }
    information.poses.push_back(pose_block);
    information.intrinsics +=
        camera_block - cross * CovarianceFromInformation(pose_block, 1) * cross.transpose();
  }
  return information;
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
