// SPDX-License-Identifier: BSD-3-Clause
#include "resample/imputation.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace lfm {
namespace {

using Eigen::Index;
// Of one size whatever the number of terms: those that are not used stay zero.
using Terms = Eigen::Matrix<float, kMaxImputationTerms, 1>;
using Factor = Eigen::Matrix<float, Eigen::Dynamic, kMaxImputationTerms, Eigen::RowMajor>;

// Of the largest singular value: small against what is known of most rows and views, large against
// noise where little is.
constexpr float kRidge_rel = 1e-3F;

/// Means of what is known of each row, and how much is known of each row and view.
struct Means {
  Eigen::VectorXf of_row;  ///< 0 where nothing is known
  Eigen::VectorXf row_count, view_count;
};

Means MeansOfKnown(const PartialMatrix& matrix) {
  const Index rows = matrix.values.rows(), views = matrix.values.cols();
  Means means{Eigen::VectorXf::Zero(rows), Eigen::VectorXf::Zero(rows),
              Eigen::VectorXf::Zero(views)};
  for (Index v = 0; v < views; ++v) {
    for (Index r = 0; r < rows; ++r) {
      if (matrix.knowledge(r, v) == Knowledge::kMissing) continue;
      means.of_row[r] += matrix.values(r, v);
      means.row_count[r] += 1;
      means.view_count[v] += 1;
    }
  }
  means.of_row.array() /= means.row_count.array().max(1);
  return means;
}

/// The matrix with its gaps filled by the row's mean, for a start.
Eigen::MatrixXf FillGaps(const PartialMatrix& matrix, const Means& means) {
  Eigen::MatrixXf filled = matrix.values;
  for (Index v = 0; v < filled.cols(); ++v) {
    for (Index r = 0; r < filled.rows(); ++r) {
      if (matrix.knowledge(r, v) == Knowledge::kMissing) filled(r, v) = means.of_row[r];
    }
  }
  return filled;
}

struct Factors {
  Factor rows, views;
  float ridge = 0;
};

/// Principal terms of the filled matrix, the singular value shared evenly by both sides: then one
/// ridge holds a weak term back more than a strong one.
Factors StartFactors(const Eigen::MatrixXf& filled, int terms) {
  // Products in double: squaring doubles the digits that a weak term needs beside a strong one.
  const Eigen::MatrixXd exact = filled.cast<double>();
  const Eigen::MatrixXd gram = exact.transpose() * exact;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram);
  Factors factors;
  factors.rows.setZero(filled.rows(), kMaxImputationTerms);
  factors.views.setZero(filled.cols(), kMaxImputationTerms);
  for (int k = 0; k < terms; ++k) {
    const Index column = filled.cols() - 1 - k;
    const double singular = std::sqrt(std::max(0.0, solver.eigenvalues()[column]));
    if (!(singular > 0)) break;
    const Eigen::VectorXf direction = solver.eigenvectors().col(column).cast<float>();
    const auto root = static_cast<float>(std::sqrt(singular));
    factors.views.col(k) = direction * root;
    factors.rows.col(k) = filled * direction / root;
    if (k == 0) factors.ridge = kRidge_rel * static_cast<float>(singular);
  }
  return factors;
}

/// Ridge regression of one row (or view) on the other side's terms, by the normal equations; a term
/// that is zero throughout stays zero, and so does all without a ridge (of data that are zero).
class Regression {
 public:
  void Add(const Terms& terms, float value) {
    gram_.noalias() += terms * terms.transpose();
    right_ += value * terms;
  }
  /// `expected`: what little data leave the answer at.
  Terms Solve(float ridge, const Terms& expected) const {
    if (!(ridge > 0)) return Terms::Zero();
    Gram gram = gram_;
    gram.diagonal().array() += ridge;
    return gram.llt().solve(right_ + ridge * expected);
  }

 private:
  using Gram = Eigen::Matrix<float, kMaxImputationTerms, kMaxImputationTerms>;
  Gram gram_ = Gram::Zero();
  Terms right_ = Terms::Zero();
};

/// One sweep: every row given the views, or, with the roles exchanged by the accessors, the other
/// way round.
template <typename Value, typename Kind>
void Sweep(const Factor& basis, float ridge, const Terms& expected, const Value& value,
           const Kind& kind, Factor& solved) {
  for (Index i = 0; i < solved.rows(); ++i) {
    Regression regression;
    for (Index j = 0; j < basis.rows(); ++j) {
      const Knowledge known = kind(i, j);
      if (known == Knowledge::kMissing) continue;
      const Terms terms = basis.row(j);
      const bool reached =
          known == Knowledge::kLowerBound && solved.row(i).dot(terms.transpose()) >= value(i, j);
      if (!reached) regression.Add(terms, value(i, j));
    }
    solved.row(i) = regression.Solve(ridge, expected).transpose();
  }
}

/// Fits `terms` terms, from those of `start`, which has no gaps.
Factors Fit(const PartialMatrix& matrix, const Eigen::MatrixXf& start, int terms, int sweeps) {
  Factors factors = StartFactors(start, terms);
  const auto value = [&](Index r, Index v) { return matrix.values(r, v); };
  const auto kind = [&](Index r, Index v) { return matrix.knowledge(r, v); };
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    Sweep(factors.views, factors.ridge, Terms::Zero(), value, kind, factors.rows);
    // A view that tells little looks like the mean of all, not like a darker one.
    const Terms mean_view = factors.views.colwise().mean().transpose();
    Sweep(
        factors.rows, factors.ridge, mean_view, [&](Index v, Index r) { return value(r, v); },
        [&](Index v, Index r) { return kind(r, v); }, factors.views);
  }
  return factors;
}

/// The matrix with what the fit says where there are no data.
Eigen::MatrixXf FillFromFit(const PartialMatrix& matrix, const Means& means, const Factors& factors,
                            float ceiling) {
  Eigen::MatrixXf result = matrix.values;
  for (Index v = 0; v < result.cols(); ++v) {
    for (Index r = 0; r < result.rows(); ++r) {
      const Knowledge known = matrix.knowledge(r, v);
      if (known == Knowledge::kData) continue;
      float estimate = factors.rows.row(r).dot(factors.views.row(v));
      if (known == Knowledge::kLowerBound) {
        estimate = std::max(estimate, matrix.values(r, v));
      } else if (means.row_count[r] == 0 || means.view_count[v] == 0) {
        estimate = means.of_row[r];
      }
      result(r, v) = std::clamp(estimate, 0.0F, ceiling);
    }
  }
  return result;
}

}  // namespace

Eigen::MatrixXf Impute(const PartialMatrix& matrix, float ceiling, int max_terms) {
  constexpr int kSweeps = 20, kMoreSweeps = 10;
  constexpr Index kTermsOfBounds = 2, kViewsForATerm = 3;
  if ((matrix.knowledge.array() == Knowledge::kData).all()) return matrix.values;
  const Means means = MeansOfKnown(matrix);
  const Index most = std::clamp<Index>(matrix.values.cols() / kViewsForATerm, 1,
                                       std::clamp(max_terms, 1, kMaxImputationTerms));
  const auto first = static_cast<int>(std::min(most, kTermsOfBounds));
  Eigen::MatrixXf filled =
      FillFromFit(matrix, means, Fit(matrix, FillGaps(matrix, means), first, kSweeps), ceiling);
  const bool gaps = (matrix.knowledge.array() == Knowledge::kMissing).any();
  if (most == first || !gaps) return filled;
  // More terms would be free to shoot up over bounds: these count as found now.
  PartialMatrix rest{filled, matrix.knowledge};
  for (Knowledge& known : rest.knowledge.reshaped()) {
    if (known == Knowledge::kLowerBound) known = Knowledge::kData;
  }
  return FillFromFit(rest, means, Fit(rest, filled, static_cast<int>(most), kMoreSweeps), ceiling);
}

}  // namespace lfm
