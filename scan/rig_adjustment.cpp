// SPDX-License-Identifier: BSD-3-Clause
#include "scan/rig_adjustment.h"

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "scan/rig_problem.h"
#include "scan/solver_log.h"

namespace lfm {
namespace {

constexpr double kSingular = 1e300;
constexpr double kSameSigma = 0.9;

/// J^T J, dense, at the problem's present parameters; columns in the order of `blocks` (free
/// directions only). Empty when a residual cannot be evaluated.
struct NormalMatrix {
  Eigen::MatrixXd values;
  bool valid = false;
};

NormalMatrix ComputeNormalMatrix(RigProblem& a, const std::vector<double*>& blocks) {
  NormalMatrix normal;
  ceres::Problem::EvaluateOptions evaluate;
  for (double* block : blocks) {
    if (a.problem.HasParameterBlock(block) && !a.problem.IsParameterBlockConstant(block)) {
      evaluate.parameter_blocks.push_back(block);
    }
  }
  ceres::CRSMatrix jacobian;
  if (evaluate.parameter_blocks.empty() ||
      !a.problem.Evaluate(evaluate, nullptr, nullptr, nullptr, &jacobian)) {
    return normal;
  }
  normal.values = Eigen::MatrixXd::Zero(jacobian.num_cols, jacobian.num_cols);
  for (int row = 0; row < jacobian.num_rows; ++row) {
    const size_t begin = jacobian.rows[row], end = jacobian.rows[row + 1];
    for (size_t i = begin; i < end; ++i) {
      for (size_t j = begin; j < end; ++j) {
        normal.values(jacobian.cols[i], jacobian.cols[j]) +=
            jacobian.values[i] * jacobian.values[j];
      }
    }
  }
  normal.valid = normal.values.allFinite();
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

/// Inverse of a positive definite matrix after scaling to unit diagonal; empty when singular.
Eigen::MatrixXd InverseOrEmpty(const Eigen::MatrixXd& matrix) {
  const Eigen::VectorXd diagonal = matrix.diagonal();
  if (!(diagonal.minCoeff() > 0)) return {};
  const Eigen::VectorXd scale = diagonal.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd unit = scale.asDiagonal() * matrix * scale.asDiagonal();
  const Eigen::LDLT<Eigen::MatrixXd> factor(unit);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 1e-13)) return {};
  const Eigen::MatrixXd inverse =
      factor.solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
  return scale.asDiagonal() * inverse * scale.asDiagonal();
}

/// Poses are eliminated first. Within a group Ceres sorts by address, which differs from run to
/// run, so every other block has a group of its own.
std::shared_ptr<ceres::ParameterBlockOrdering> PosesFirst(RigProblem& a) {
  std::vector<double*> others = a.ProjectorBlocks();
  others.push_back(a.camera.data());
  for (RunParameters& run : a.runs) {
    others.push_back(run.axis.data());
    others.push_back(run.base.data());
    for (double& angle : run.angles) others.push_back(&angle);
  }
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  int group = 1;
  for (double* block : others) {
    if (a.problem.HasParameterBlock(block)) ordering->AddElementToGroup(block, group++);
  }
  for (PoseParameters& pose : a.platforms) {
    if (a.problem.HasParameterBlock(pose.data())) ordering->AddElementToGroup(pose.data(), 0);
  }
  return ordering;
}

RigState SolveOnce(const RigState& start, const RigData& data, const RigFreedom& freedom,
                   const RigCalibrationOptions& options, double corner_sigma_px) {
  const std::unique_ptr<RigProblem> a =
      BuildRigProblem(start, data, freedom, options, corner_sigma_px);
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  solver.linear_solver_ordering = PosesFirst(*a);
  solver.max_num_iterations = 100;
  solver.function_tolerance = 1e-12;
  solver.parameter_tolerance = 1e-12;
  solver.gradient_tolerance = 1e-14;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  SilenceSolverLog();
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &a->problem, &summary);
  if (!summary.IsSolutionUsable()) {
    throw Error("the adjustment of projector and platform placements failed (" + summary.message +
                "); check that the placements' pictures belong to this rig");
  }
  return StateOf(*a, start);
}

}  // namespace

RigState AdjustRig(const RigState& start, const RigData& data, const RigFreedom& freedom,
                   const RigCalibrationOptions& options) {
  const double sigma_px = CornerSigmaPx(start, data.placements);
  const RigState once = SolveOnce(start, data, freedom, options, sigma_px);
  // A start that is off makes corners look noisier than they are.
  const double better_px = CornerSigmaPx(once, data.placements);
  return better_px < kSameSigma * sigma_px ? SolveOnce(start, data, freedom, options, better_px)
                                           : once;
}

double RigCondition(const RigState& state, const RigData& data,
                    const RigCalibrationOptions& options) {
  const std::unique_ptr<RigProblem> a =
      BuildRigProblem(state, data, {}, options, CornerSigmaPx(state, data.placements));
  std::vector<double*> blocks = {a->pinhole.data(), a->turn.data(), a->translation.data()};
  for (PoseParameters& pose : a->platforms) blocks.push_back(pose.data());
  const NormalMatrix normal = ComputeNormalMatrix(*a, blocks);
  constexpr int kProjector = 10;
  if (!normal.valid || normal.values.cols() <= kProjector) return kSingular;
  const Eigen::Index rest = normal.values.cols() - kProjector;
  const Eigen::MatrixXd cross = normal.values.topRightCorner(kProjector, rest);
  const Eigen::MatrixXd inner = normal.values.bottomRightCorner(rest, rest);
  const Eigen::MatrixXd reduced = normal.values.topLeftCorner(kProjector, kProjector) -
                                  cross * inner.ldlt().solve(cross.transpose());
  return ScaledCondition(reduced);
}

RigCovariance ComputeRigCovariance(const RigState& state, const RigData& data,
                                   const RigFreedom& freedom,
                                   const RigCalibrationOptions& options) {
  RigCovariance result;
  result.platforms.assign(data.placements.size(), Eigen::Matrix<double, 6, 6>::Zero());
  const RigData without_runs{data.placements, data.correspondences, data.included};
  const std::unique_ptr<RigProblem> a =
      BuildRigProblem(state, without_runs, freedom, options, CornerSigmaPx(state, data.placements));
  std::vector<double*> blocks;
  std::vector<Eigen::Index> projector_places;  // rows of RigCovariance::projector
  if (freedom.projector) {
    blocks = a->ProjectorBlocks();
    for (int i = 0; i < 14; ++i) {
      const bool held_lens = i >= 4 + freedom.projector_terms && i < 8;
      if (!held_lens) projector_places.push_back(i);
    }
  }
  std::vector<size_t> posed;
  for (size_t i = 0; i < a->platforms.size(); ++i) {
    if (!a->problem.HasParameterBlock(a->platforms[i].data())) continue;
    blocks.push_back(a->platforms[i].data());
    posed.push_back(i);
  }
  const auto poses_begin = static_cast<Eigen::Index>(projector_places.size());
  const NormalMatrix normal = ComputeNormalMatrix(*a, blocks);
  if (!normal.valid) return result;
  const Eigen::MatrixXd covariance = InverseOrEmpty(normal.values);
  if (covariance.size() == 0) return result;
  for (size_t i = 0; i < projector_places.size(); ++i) {
    for (size_t j = 0; j < projector_places.size(); ++j) {
      result.projector(projector_places[i], projector_places[j]) =
          covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    }
  }
  for (size_t i = 0; i < posed.size(); ++i) {
    const Eigen::Index at = poses_begin + 6 * static_cast<Eigen::Index>(i);
    result.platforms[posed[i]] = covariance.block<6, 6>(at, at);
  }
  return result;
}

std::optional<Eigen::Vector2d> RigResidualPx(const RigState& state,
                                             const PlateCorrespondence& seen) {
  const Eigen::Vector3d point =
      MeetPlate(state.platforms[static_cast<size_t>(seen.placement)], seen.ray, seen.plate);
  const std::optional<Eigen::Vector2d> pixel =
      Project(state.projector, state.projector_from_camera * point);
  if (!pixel || !pixel->allFinite()) return std::nullopt;
  Eigen::Vector2d residual = *pixel - seen.projector_px;
  if (!(seen.sigma_px.y() > 0)) residual.y() = 0;
  return residual;
}

double CornerRmsPx(const RigState& state, const std::vector<PlatePlacement>& placements) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < placements.size(); ++i) {
    for (const SeenCorner& seen : placements[i].corners) {
      const auto pixel = Project(state.camera, state.platforms[i] * seen.point_in_world);
      if (!pixel) continue;
      sum += (*pixel - seen.pixel).squaredNorm();
      count += 1;
    }
  }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

}  // namespace lfm
