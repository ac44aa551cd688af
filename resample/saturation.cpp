// SPDX-License-Identifier: BSD-3-Clause
#include "resample/saturation.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace lfm {
namespace {

// Small against the data's own weight, large enough for rows and views with little data.
constexpr float kRidge_rel = 1e-3F;
constexpr int kSweeps = 20;

struct Factors {
  Eigen::MatrixXf rows;   ///< rows x K
  Eigen::MatrixXf views;  ///< views x K
};

/// The best rank-K start: principal views of the matrix as it stands, bounds included.
Factors StartFactors(const Eigen::MatrixXf& values, Eigen::Index terms) {
  const Eigen::MatrixXd gram = (values.transpose() * values).cast<double>();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram);
  Factors factors;
  factors.views = solver.eigenvectors().rightCols(terms).cast<float>();
  factors.rows = values * factors.views;
  return factors;
}

/// Least squares for one side's vector: `basis` is the other side's, entries with weight 0 do not
/// count, the ridge is relative to what all entries together would weigh.
Eigen::VectorXf SolveOne(const Eigen::MatrixXf& basis, const Eigen::VectorXf& target,
                         const Eigen::VectorXf& weight, float ridge) {
  Eigen::MatrixXf normal = basis.transpose() * weight.asDiagonal() * basis;
  normal.diagonal().array() += ridge;
  const Eigen::VectorXf right = basis.transpose() * weight.cwiseProduct(target);
  return normal.ldlt().solve(right);
}

float RidgeFor(const Eigen::MatrixXf& basis) {
  return kRidge_rel * basis.squaredNorm() / static_cast<float>(basis.cols()) + 1e-20F;
}

/// 1 for data, and for bounds that the fit does not reach.
Eigen::MatrixXf ActiveWeights(const CensoredMatrix& matrix, const Eigen::MatrixXf& fit) {
  const Eigen::MatrixXf ones = Eigen::MatrixXf::Ones(fit.rows(), fit.cols());
  return (matrix.is_censored.array() && (fit.array() >= matrix.values.array())).select(0.0F, ones);
}

}  // namespace

Eigen::MatrixXf ImputeCensored(const CensoredMatrix& matrix, float ceiling) {
  // A diffuse and a glossy part; more terms explain the cut-off peak by itself.
  constexpr Eigen::Index kTerms = 2, kFewestViews = 6;
  const Eigen::MatrixXf& values = matrix.values;
  const Eigen::MatrixXf bounded =
      matrix.is_censored.select(values.array().min(ceiling).matrix(), values);
  const bool can_fit = values.cols() >= kFewestViews && values.rows() >= kTerms &&
                       matrix.is_censored.any() && !matrix.is_censored.all();
  if (!can_fit) return bounded;
  Factors factors = StartFactors(values, kTerms);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const Eigen::MatrixXf weights = ActiveWeights(matrix, factors.rows * factors.views.transpose());
    const float row_ridge = RidgeFor(factors.views);
    for (Eigen::Index r = 0; r < values.rows(); ++r) {
      factors.rows.row(r) =
          SolveOne(factors.views, values.row(r).transpose(), weights.row(r).transpose(), row_ridge)
              .transpose();
    }
    const float view_ridge = RidgeFor(factors.rows);
    for (Eigen::Index v = 0; v < values.cols(); ++v) {
      factors.views.row(v) =
          SolveOne(factors.rows, values.col(v), weights.col(v), view_ridge).transpose();
    }
  }
  const Eigen::MatrixXf fit = factors.rows * factors.views.transpose();
  return matrix.is_censored.select(fit.cwiseMax(values).array().min(ceiling).matrix(), bounded);
}

}  // namespace lfm
