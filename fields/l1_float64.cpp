// SPDX-License-Identifier: BSD-3-Clause
#include "fields/l1_float64.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/huber_programme.h"
#include "fields/l1_edge_descent.h"
#include "fields/l1_linear_programme.h"
#include "fields/l1_one_sided.h"
#include "fields/l1_reweighted.h"
#include "fields/orthonormal_basis.h"

namespace lfm {
namespace {

Eigen::VectorXd SolveOneSided(const Eigen::MatrixXd& functions, const Eigen::VectorXd& target,
                              const L1Options& options, int64_t row) {
  if (options.solver == L1Solver::kQuadraticProgramme) {
    throw Error("L1: the quadratic programme has no positive residual");
  }
  if (options.solver != L1Solver::kLinearProgramme) {
    // Where it gives up, the programme says whether there are none.
    if (const auto vertex = DescendOneSided(functions, target)) return vertex->weights;
  }
  if (const auto weights = SolveLinearProgramme(functions, target, ResidualSign::kPositive)) {
    return *weights;
  }
  throw Error("L1: no weights leave a positive residual of row " + std::to_string(row));
}

Eigen::VectorXd SolveRow(const Eigen::MatrixXd& functions, const Eigen::VectorXd& target,
                         const Eigen::VectorXd& start, const L1Options& options, int64_t row) {
  if (options.sign == ResidualSign::kPositive) {
    return SolveOneSided(functions, target, options, row);
  }
  if (options.solver == L1Solver::kQuadraticProgramme) {
    return SolveHuberProgramme(functions, target, options.huber_gamma);
  }
  if (options.solver == L1Solver::kExact) {
    if (const auto vertex = DescendEdges(functions, target, start)) return vertex->weights;
  }
  return SolveLinearProgramme(functions, target, ResidualSign::kAny).value();
}

double StoredError(RowsView basis, const float* weights, const float* target) {
  double error = 0;
  for (int j = 0; j < basis.columns; ++j) {
    double rest = target[j];
    for (int64_t t = 0; t < basis.rows; ++t) rest -= double{weights[t]} * basis.Row(t)[j];
    error += std::abs(rest);
  }
  return error;
}

}  // namespace

Float64Basis ShareInFloat64(RowsView basis) {
  const OrthonormalBasis orthonormal = Orthonormalize(basis);
  const double length = std::sqrt(static_cast<double>(basis.columns));
  return {orthonormal.functions * length, orthonormal.mixing.transpose() / length,
          orthonormal.inverse.transpose() * length};
}

Float64Row ScaledRow(const float* row, int columns) {
  Float64Row result;
  result.target = Eigen::Map<const Eigen::VectorXf>(row, columns).cast<double>();
  const double mean = result.target.cwiseAbs().mean();
  if (mean > 0) result.exponent = std::ilogb(mean);
  result.target *= std::ldexp(1.0, -result.exponent);
  return result;
}

Eigen::VectorXd ToShared(const Float64Basis& shared, const Float64Row& row, const float* weights) {
  const Eigen::Map<const Eigen::VectorXf> own(weights, shared.from_basis.cols());
  return shared.from_basis * own.cast<double>() * std::ldexp(1.0, -row.exponent);
}

Eigen::VectorXd FromShared(const Float64Basis& shared, const Float64Row& row,
                           const Eigen::VectorXd& weights) {
  return shared.to_basis * weights * std::ldexp(1.0, row.exponent);
}

L1Solution SolveInFloat64(RowsView basis, RowsView targets, const L1Options& options,
                          const std::vector<float>& start) {
  RequireFinite(targets, "L1 targets");
  const Float64Basis shared = ShareInFloat64(basis);
  const int64_t terms = basis.rows;
  // A feasible optimum needs no start, and an infeasible start would pass for a better one.
  const bool started = options.sign == ResidualSign::kAny;
  L1Solution solution;
  if (started && options.solver == L1Solver::kExact) {
    solution = SolveReweighted(basis, targets, options.iterations, start, kernels::BestL1Kernels());
  } else if (started && !start.empty()) {
    solution.weights = start;
  } else {
    solution.weights.resize(targets.rows * terms);
  }
  solution.errors.resize(targets.rows);
  const bool keeps_better = started && (!start.empty() || options.solver == L1Solver::kExact);
  ParallelFor(0, targets.rows, [&](int64_t i) {
    float* weights = solution.weights.data() + i * terms;
    const Float64Row row = ScaledRow(targets.Row(i), targets.columns);
    const Eigen::VectorXd found = FromShared(
        shared, row,
        SolveRow(shared.functions, row.target, ToShared(shared, row, weights), options, i));
    const Eigen::VectorXf stored = found.cast<float>();
    const double error = StoredError(basis, stored.data(), targets.Row(i));
    solution.errors[i] = keeps_better ? StoredError(basis, weights, targets.Row(i)) : error;
    if (keeps_better && solution.errors[i] <= error) return;
    solution.errors[i] = error;
    std::copy(stored.begin(), stored.end(), weights);
  });
  return solution;
}

}  // namespace lfm
