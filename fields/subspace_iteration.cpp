// SPDX-License-Identifier: BSD-3-Clause
#include "fields/subspace_iteration.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "fields/matrix_products.h"

namespace lfm {
namespace {

// Random signs that depend on their place alone.
float SignAt(uint64_t place) {
  uint64_t x = (place + 1) * 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return (x >> 40 & 1) != 0 ? 1.0f : -1.0f;
}

// A times `count` columns of random signs, brought to the size of ordinary numbers.
FunctionRows RandomCombinations(RowsView a, int first, int count, double scale) {
  FunctionRows signs = MakeFunctionRows(a.columns, count);
  for (int64_t row = 0; row < signs.rows; ++row) {
    for (int j = 0; j < count; ++j) {
      signs.Row(row)[j] = SignAt(static_cast<uint64_t>(row) << 20 | (first + j));
    }
  }
  FunctionRows combined = Times(a, signs.View());
  for (float& value : combined.values) value = static_cast<float>(value * scale);
  return combined;
}

FunctionRows SideBySide(const FunctionRows& left, const FunctionRows& right) {
  if (left.rows == 0) return right;
  FunctionRows both = MakeFunctionRows(left.rows, left.columns + right.columns);
  for (int64_t row = 0; row < both.rows; ++row) {
    std::copy_n(right.Row(row), right.columns,
                std::copy_n(left.Row(row), left.columns, both.Row(row)));
  }
  return both;
}

FunctionRows InSingle(const Eigen::MatrixXd& m) {
  FunctionRows rows = MakeFunctionRows(m.rows(), static_cast<int>(m.cols()));
  for (int64_t i = 0; i < m.rows(); ++i) {
    for (int64_t j = 0; j < m.cols(); ++j) rows.Row(i)[j] = static_cast<float>(m(i, j));
  }
  return rows;
}

// What makes columns with this Gram matrix orthonormal: the inverse of its Cholesky factor, which
// keeps their order, or, where they depend on each other, scaled eigenvectors of fewer columns.
Eigen::MatrixXd Orthonormalizer(const Eigen::MatrixXd& gram) {
  const Eigen::VectorXd scale =
      gram.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 0.0; });
  const Eigen::MatrixXd scaled = scale.asDiagonal() * gram * scale.asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> factor(scaled);
  const Eigen::MatrixXd lower = factor.matrixL();
  constexpr double kLeastPivot = 1e-4;
  if (factor.info() == Eigen::Success && lower.diagonal().minCoeff() > kLeastPivot) {
    const auto size = gram.rows();
    return scale.asDiagonal() * factor.matrixU().solve(Eigen::MatrixXd::Identity(size, size));
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
  const Eigen::VectorXd& values = solver.eigenvalues();
  constexpr double kLeast = 1e-10;  // relative: below lies what float32 made of nothing
  const auto kept = (values.array() > kLeast * values.tail(1)(0)).count();
  return scale.asDiagonal() * solver.eigenvectors().rightCols(kept).rowwise().reverse() *
         values.tail(kept).reverse().cwiseSqrt().cwiseInverse().asDiagonal();
}

FunctionRows Orthonormal(FunctionRows columns) {
  for (int pass = 0; pass < 2; ++pass) {
    columns =
        Times(columns.View(), InSingle(Orthonormalizer(GramOfColumns(columns.View()))).View());
  }
  return columns;
}

double Captured(const FunctionRows& projected) { return EnergyOf(projected.View()); }

// Q^T A once its energy hardly changes any more, or after one round where it is too little for the
// share anyway. `basis` becomes the Q that belongs to it.
FunctionRows Converge(RowsView a, const SubspaceTarget& target, bool may_grow,
                      FunctionRows& basis) {
  constexpr int kMostRounds = 12;
  constexpr double kLeastMissing = 1e-8;
  const auto scale = static_cast<float>(1 / std::sqrt(target.energy));
  FunctionRows projected = TransposedTimes(basis.View(), a);
  double caught = Captured(projected);
  for (int round = 0; round < kMostRounds; ++round) {
    FunctionRows scaled = projected;
    for (float& value : scaled.values) value *= scale;
    basis = Orthonormal(TimesTransposed(a, scaled.View()));
    projected = TransposedTimes(basis.View(), a);
    const double now = Captured(projected);
    if (may_grow && now < target.share * target.energy) break;
    const double missing = std::max(target.energy - now, kLeastMissing * target.energy);
    const bool settled = now - caught < target.tolerance * missing;
    caught = now;
    if (settled) break;
  }
  return projected;
}

Subspace RitzPairs(FunctionRows projected) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(GramOfRows(projected.View()));
  Subspace result;
  for (auto i = solver.eigenvalues().size(); i-- > 0;) {
    result.energies.push_back(std::max(0.0, solver.eigenvalues()(i)));
  }
  result.rotation = solver.eigenvectors().rowwise().reverse();
  result.projected = std::move(projected);
  return result;
}

}  // namespace

Subspace IterateSubspace(RowsView a, const SubspaceTarget& target) {
  constexpr int kLeastSize = 24;
  const int side = static_cast<int>(std::min<int64_t>(a.rows, a.columns));
  const auto with_margin = [side](int64_t terms) {
    return static_cast<int>(std::min<int64_t>(side, terms + terms / 8 + 8));
  };
  const int most = with_margin(std::min(target.terms, target.most_terms));
  int size = std::clamp(with_margin(target.expected_terms), std::min(kLeastSize, most), most);
  FunctionRows basis;
  const double scale = 1 / std::sqrt(target.energy);
  for (int first = 0;;) {
    basis = Orthonormal(SideBySide(basis, RandomCombinations(a, first, size - first, scale)));
    FunctionRows projected = Converge(a, target, size < most, basis);
    const bool all = basis.columns < size || size == most;  // fewer: the rank is used up
    if (!all && Captured(projected) < target.share * target.energy) {
      first = size;
      size = std::min(2 * size, most);
      continue;
    }
    Subspace result = RitzPairs(std::move(projected));
    double sum = 0;
    int needed = 0;
    const auto found = static_cast<int>(result.energies.size());
    while (needed < std::min(found, target.terms) && sum < target.share * target.energy) {
      sum += result.energies[needed++];
    }
    const bool enough = needed >= target.terms || sum >= target.share * target.energy;
    result.holds_share = enough || basis.columns < size || size == side;
    if (result.holds_share && (with_margin(needed) <= basis.columns || all)) return result;
    if (all) return result;
    first = size;
    size = std::min(2 * size, most);
  }
}

}  // namespace lfm
