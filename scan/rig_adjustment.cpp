// SPDX-License-Identifier: BSD-3-Clause
#include "scan/rig_adjustment.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "core/lens_distortion.h"

namespace lfm {
namespace {

// Pose covariances hold the intrinsics; these floors stand for what they leave out.
constexpr double kTiltFloorRad = 2e-5;
constexpr double kDistanceFloorMm = 2e-3;
constexpr double kSingular = 1e300;

template <typename T>
Eigen::Matrix<T, 3, 1> MeetPlaneT(const PriorPlane& plane, const T* shift,
                                  const Eigen::Vector2d& ray) {
  const Eigen::Matrix<T, 3, 1> normal =
      (plane.normal.cast<T>() + shift[0] * plane.axis_u.cast<T>() +
       shift[1] * plane.axis_v.cast<T>())
          .normalized();
  const Eigen::Matrix<T, 3, 1> direction(T(ray.x()), T(ray.y()), T(1));
  return direction * ((T(plane.distance) + shift[2]) / normal.dot(direction));
}

/// Parameters: focal lengths and centre [4], lens k1 k2 p1 p2 [4], rotation vector applied on the
/// left of `rotation` [3], translation [3], plane shift [3].
struct ProjectorResidual {
  PlateCorrespondence seen;
  const PriorPlane* plane;
  Eigen::Matrix3d rotation;
  Camera lens_rest;        ///< its k3 to k6 are held
  Eigen::Vector2d weight;  ///< 1 / sigma; y is 0 where the row is unknown

  template <typename T>
  bool operator()(const T* pinhole, const T* lens, const T* turn, const T* translation,
                  const T* shift, T* residual) const {
    const Eigen::Matrix<T, 3, 1> point = MeetPlaneT(*plane, shift, seen.ray);
    const Eigen::Matrix<T, 3, 1> start = rotation.cast<T>() * point;
    T turned[3];
    ceres::AngleAxisRotatePoint(turn, start.data(), turned);
    const T z = turned[2] + translation[2];
    if (!(z > T(1e-6))) return false;
    const T x = (turned[0] + translation[0]) / z, y = (turned[1] + translation[1]) / z;
    const Eigen::Matrix<T, 2, 1> distorted =
        DistortNormalized(LensTerms<T>{lens[0], lens[1], T(lens_rest.k3), lens[2], lens[3],
                                       T(lens_rest.k4), T(lens_rest.k5), T(lens_rest.k6)},
                          x, y);
    residual[0] =
        T(weight.x()) * (pinhole[0] * distorted[0] + pinhole[2] - T(seen.projector_px.x()));
    residual[1] =
        T(weight.y()) * (pinhole[1] * distorted[1] + pinhole[3] - T(seen.projector_px.y()));
    return true;
  }
};

struct PlanePrior {
  Eigen::Matrix3d whitening;
  template <typename T>
  bool operator()(const T* shift, T* residual) const {
    Eigen::Map<Eigen::Matrix<T, 3, 1>> r(residual);
    r = whitening.cast<T>() * Eigen::Map<const Eigen::Matrix<T, 3, 1>>(shift);
    return true;
  }
};

Eigen::Matrix3d Whitening(const Eigen::Matrix3d& covariance) {
  const Eigen::LLT<Eigen::Matrix3d> factor(covariance);
  return factor.matrixL().solve(Eigen::Matrix3d::Identity());
}

/// A Ceres problem and the parameter blocks that it works on.
struct Adjustment {
  std::array<double, 4> pinhole, lens;
  std::array<double, 3> turn = {0, 0, 0}, translation;
  std::vector<std::array<double, 3>> shifts;
  ceres::Problem problem;
  std::vector<double*> projector_blocks() {
    return {pinhole.data(), turn.data(), translation.data()};
  }
};

std::unique_ptr<Adjustment> BuildAdjustment(const RigState& state,
                                            const std::vector<PriorPlane>& planes,
                                            const std::vector<PlateCorrespondence>& correspondences,
                                            const std::vector<bool>& included, int lens_terms,
                                            const RigCalibrationOptions& options) {
  auto a = std::make_unique<Adjustment>();
  const Camera& c = state.projector;
  a->pinhole = {c.fx, c.fy, c.cx, c.cy};
  a->lens = {c.k1, c.k2, c.p1, c.p2};
  const Eigen::Vector3d& t = state.projector_from_camera.translation;
  a->translation = {t.x(), t.y(), t.z()};
  for (const Eigen::Vector3d& s : state.plane_shift) a->shifts.push_back({s.x(), s.y(), s.z()});
  for (const PlateCorrespondence& seen : correspondences) {
    const size_t placement = static_cast<size_t>(seen.placement);
    if (!included[placement]) continue;
    const Eigen::Vector2d sigma =
        seen.sigma_px.cwiseAbs2().array() + options.sigma_floor_px * options.sigma_floor_px;
    Eigen::Vector2d weight = sigma.cwiseSqrt().cwiseInverse();
    if (!(seen.sigma_px.y() > 0)) weight.y() = 0;
    a->problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<ProjectorResidual, 2, 4, 4, 3, 3, 3>(new ProjectorResidual{
            seen, &planes[placement], state.projector_from_camera.rotation, c, weight}),
        new ceres::HuberLoss(options.robust_scale), a->pinhole.data(), a->lens.data(),
        a->turn.data(), a->translation.data(), a->shifts[placement].data());
  }
  for (size_t i = 0; i < planes.size(); ++i) {
    if (!included[i]) continue;
    a->problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PlanePrior, 3, 3>(
                                    new PlanePrior{Whitening(planes[i].covariance)}),
                                nullptr, a->shifts[i].data());
  }
  if (lens_terms == 0) {
    a->problem.SetParameterBlockConstant(a->lens.data());
  } else if (lens_terms < 4) {
    std::vector<int> held;
    for (int i = lens_terms; i < 4; ++i) held.push_back(i);
    a->problem.SetManifold(a->lens.data(), new ceres::SubsetManifold(4, held));
  }
  return a;
}

Eigen::MatrixXd DenseNormalMatrix(const ceres::CRSMatrix& jacobian) {
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(jacobian.num_cols, jacobian.num_cols);
  for (int row = 0; row < jacobian.num_rows; ++row) {
    const size_t begin = jacobian.rows[row], end = jacobian.rows[row + 1];
    for (size_t i = begin; i < end; ++i) {
      for (size_t j = begin; j < end; ++j) {
        normal(jacobian.cols[i], jacobian.cols[j]) += jacobian.values[i] * jacobian.values[j];
      }
    }
  }
  return normal;
}

double ScaledCondition(const Eigen::MatrixXd& matrix) {
  const Eigen::VectorXd diagonal = matrix.diagonal();
  if (!diagonal.allFinite() || !(diagonal.minCoeff() > 0)) return kSingular;
  const Eigen::VectorXd scale = diagonal.cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scale.asDiagonal() * matrix *
                                                              scale.asDiagonal());
  const double smallest = solver.eigenvalues().minCoeff();
  return smallest > 0 ? solver.eigenvalues().maxCoeff() / smallest : kSingular;
}

}  // namespace

PriorPlane PlaneOfPlacement(const PlatePlacement& placement) {
  PriorPlane plane;
  const Pose& pose = placement.camera_from_world;
  plane.axis_u = pose.rotation.col(0);
  plane.axis_v = pose.rotation.col(1);
  plane.normal = pose.rotation.col(2);
  plane.distance = plane.normal.dot(pose.translation);
  // d(normal) = w x normal; along axis_u that is w . (normal x axis_u) = w . axis_v.
  Eigen::Matrix<double, 3, 6> jacobian = Eigen::Matrix<double, 3, 6>::Zero();
  jacobian.block<1, 3>(0, 0) = plane.axis_v.transpose();
  jacobian.block<1, 3>(1, 0) = -plane.axis_u.transpose();
  jacobian.block<1, 3>(2, 0) = plane.normal.cross(pose.translation).transpose();
  jacobian.block<1, 3>(2, 3) = plane.normal.transpose();
  plane.covariance = jacobian * placement.covariance * jacobian.transpose();
  if (!plane.covariance.allFinite()) plane.covariance.setZero();
  plane.covariance(0, 0) += kTiltFloorRad * kTiltFloorRad;
  plane.covariance(1, 1) += kTiltFloorRad * kTiltFloorRad;
  plane.covariance(2, 2) += kDistanceFloorMm * kDistanceFloorMm;
  return plane;
}

Eigen::Vector3d MeetPlane(const PriorPlane& plane, const Eigen::Vector3d& shift,
                          const Eigen::Vector2d& ray) {
  return MeetPlaneT<double>(plane, shift.data(), ray);
}

RigState AdjustRig(const RigState& start, const std::vector<PriorPlane>& planes,
                   const std::vector<PlateCorrespondence>& correspondences,
                   const std::vector<bool>& included, int lens_terms,
                   const RigCalibrationOptions& options) {
  const auto a = BuildAdjustment(start, planes, correspondences, included, lens_terms, options);
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  solver.max_num_iterations = 100;
  solver.function_tolerance = 1e-12;
  solver.parameter_tolerance = 1e-12;
  solver.gradient_tolerance = 1e-14;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &a->problem, &summary);
  if (!summary.IsSolutionUsable()) {
    throw Error("the adjustment of projector and platform placements failed (" + summary.message +
                "); check that the placements' pictures belong to this rig");
  }
  RigState state = start;
  Camera& c = state.projector;
  c.fx = a->pinhole[0];
  c.fy = a->pinhole[1];
  c.cx = a->pinhole[2];
  c.cy = a->pinhole[3];
  c.k1 = a->lens[0];
  c.k2 = a->lens[1];
  c.p1 = a->lens[2];
  c.p2 = a->lens[3];
  const Eigen::Vector3d turn(a->turn.data());
  const double angle = turn.norm();
  if (angle > 0) {
    state.projector_from_camera.rotation =
        Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() *
        start.projector_from_camera.rotation;
  }
  state.projector_from_camera.translation = Eigen::Vector3d(a->translation.data());
  for (size_t i = 0; i < planes.size(); ++i) {
    state.plane_shift[i] = Eigen::Vector3d(a->shifts[i].data());
  }
  return state;
}

double RigCondition(const RigState& state, const std::vector<PriorPlane>& planes,
                    const std::vector<PlateCorrespondence>& correspondences,
                    const RigCalibrationOptions& options) {
  const auto a = BuildAdjustment(state, planes, correspondences,
                                 std::vector<bool>(planes.size(), true), 0, options);
  ceres::Problem::EvaluateOptions evaluate;
  evaluate.parameter_blocks = a->projector_blocks();
  for (auto& shift : a->shifts) evaluate.parameter_blocks.push_back(shift.data());
  ceres::CRSMatrix jacobian;
  if (!a->problem.Evaluate(evaluate, nullptr, nullptr, nullptr, &jacobian)) return kSingular;
  const Eigen::MatrixXd normal = DenseNormalMatrix(jacobian);
  constexpr int kProjector = 10;
  const Eigen::Index rest = normal.cols() - kProjector;
  const Eigen::MatrixXd cross = normal.topRightCorner(kProjector, rest);
  const Eigen::MatrixXd inner = normal.bottomRightCorner(rest, rest);
  const Eigen::MatrixXd reduced =
      normal.topLeftCorner(kProjector, kProjector) - cross * inner.ldlt().solve(cross.transpose());
  return ScaledCondition(reduced);
}

std::optional<Eigen::Vector2d> RigResidualPx(const RigState& state,
                                             const std::vector<PriorPlane>& planes,
                                             const PlateCorrespondence& seen) {
  const size_t placement = static_cast<size_t>(seen.placement);
  const Eigen::Vector3d point =
      MeetPlane(planes[placement], state.plane_shift[placement], seen.ray);
  const std::optional<Eigen::Vector2d> pixel =
      Project(state.projector, state.projector_from_camera * point);
  if (!pixel || !pixel->allFinite()) return std::nullopt;
  Eigen::Vector2d residual = *pixel - seen.projector_px;
  if (!(seen.sigma_px.y() > 0)) residual.y() = 0;
  return residual;
}

}  // namespace lfm
