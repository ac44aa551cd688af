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
Eigen::MatrixXf ActiveWeights(const CensoredMatrix& matrix, const Eigen::MatrixXf& bounds,
                              const Eigen::MatrixXf& fit) {
  return (matrix.is_censored.array() && (fit.array() >= bounds.array()))
      .select(0.0F, Eigen::MatrixXf::Ones(bounds.rows(), bounds.cols()));
}

}  // namespace

Eigen::MatrixXf ImputeCensored(const CensoredMatrix& matrix, float ceiling) {
  constexpr Eigen::Index kMaxTerms = 3, kViewsPerTerm = 6;
  const Eigen::Index views = matrix.values.cols();
  const Eigen::Index terms = std::min({kMaxTerms, views / kViewsPerTerm, matrix.values.rows()});
  Eigen::MatrixXf result = matrix.values.array().min(ceiling).matrix();
  result = matrix.is_censored.select(result, matrix.values);
  if (terms == 0 || !matrix.is_censored.any() || matrix.is_censored.all()) return result;

  const Eigen::VectorXf mean = matrix.values.rowwise().mean();
  const Eigen::MatrixXf centered = matrix.values.colwise() - mean;
  Factors factors = StartFactors(centered, terms);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const Eigen::MatrixXf weights =
        ActiveWeights(matrix, centered, factors.rows * factors.views.transpose());
    const float row_ridge = RidgeFor(factors.views);
    for (Eigen::Index r = 0; r < centered.rows(); ++r) {
      factors.rows.row(r) = SolveOne(factors.views, centered.row(r).transpose(),
                                     weights.row(r).transpose(), row_ridge)
                                .transpose();
    }
    const float view_ridge = RidgeFor(factors.rows);
    for (Eigen::Index v = 0; v < views; ++v) {
      factors.views.row(v) =
          SolveOne(factors.rows, centered.col(v), weights.col(v), view_ridge).transpose();
    }
  }
  const Eigen::MatrixXf fit = (factors.rows * factors.views.transpose()).colwise() + mean;
  return matrix.is_censored.select(fit.cwiseMax(matrix.values).array().min(ceiling).matrix(),
                                   result);
}

}  // namespace lfm
