// SPDX-License-Identifier: BSD-3-Clause
#include "fields/orthonormal_basis.h"

#include <Eigen/Dense>
#include <vector>

namespace lfm {

OrthonormalBasis Orthonormalize(RowsView basis) {
  constexpr double kDependent = 1e-5;
  const int terms = static_cast<int>(basis.rows), columns = basis.columns;
  // Functions in columns, so that they lie in a piece.
  Eigen::MatrixXd rest(columns, terms);
  for (int t = 0; t < terms; ++t) {
    rest.col(t) = Eigen::Map<const Eigen::VectorXf>(basis.Row(t), columns).cast<double>();
  }
  const Eigen::MatrixXd all = rest;
  const Eigen::VectorXd norms = all.colwise().norm();
  Eigen::MatrixXd found(columns, terms);
  std::vector<int> kept;
  for (int rank = 0; rank < std::min(terms, columns); ++rank) {
    int next = -1;
    double most = kDependent;
    for (int t = 0; t < terms; ++t) {
      const double left = norms[t] > 0 ? rest.col(t).norm() / norms[t] : 0;
      if (left > most) {
        most = left;
        next = t;
      }
    }
    if (next < 0) break;
    Eigen::VectorXd q = rest.col(next).normalized();
    q -= found.leftCols(rank) * (found.leftCols(rank).transpose() * q);
    q.normalize();
    found.col(rank) = q;
    rest.col(next).setZero();
    for (int t = 0; t < terms; ++t) rest.col(t) -= q * q.dot(rest.col(t));
    kept.push_back(next);
  }
  const int rank = static_cast<int>(kept.size());
  OrthonormalBasis result;
  result.functions = found.leftCols(rank).transpose();
  result.mixing = all.transpose() * found.leftCols(rank);
  result.inverse = Eigen::MatrixXd::Zero(rank, terms);
  // Of the kept functions, in the order of keeping, L is lower triangular.
  Eigen::MatrixXd triangle(rank, rank);
  for (int i = 0; i < rank; ++i) triangle.row(i) = result.mixing.row(kept[i]);
  const Eigen::MatrixXd solved =
      triangle.triangularView<Eigen::Lower>().solve(Eigen::MatrixXd::Identity(rank, rank));
  for (int i = 0; i < rank; ++i) result.inverse.col(kept[i]) = solved.col(i);
  return result;
}

}  // namespace lfm
