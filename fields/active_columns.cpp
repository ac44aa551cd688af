// SPDX-License-Identifier: BSD-3-Clause
#include "fields/active_columns.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace lfm {
namespace {

// Columns found so far span an orthonormal set; what of q lies outside it.
Eigen::VectorXd Outside(const Eigen::MatrixXd& spanned, int count, const Eigen::VectorXd& q) {
  Eigen::VectorXd rest = q - spanned.leftCols(count) * (spanned.leftCols(count).transpose() * q);
  return rest - spanned.leftCols(count) * (spanned.leftCols(count).transpose() * rest);
}

}  // namespace

std::vector<int> IndependentColumns(const Eigen::MatrixXd& functions, const Eigen::VectorXd& cost) {
  // Of a column that is taken for its cost, so much must be new: the vertex shall be well posed.
  constexpr double kLeastNew = 1e-3;
  const int rank = static_cast<int>(functions.rows()), columns = static_cast<int>(cost.size());
  std::vector<int> order(columns), found;
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return cost[a] < cost[b]; });
  Eigen::MatrixXd spanned(rank, rank);
  for (int at = 0; at < columns && static_cast<int>(found.size()) < rank; ++at) {
    const int count = static_cast<int>(found.size());
    const Eigen::VectorXd rest = Outside(spanned, count, functions.col(order[at]));
    const double length = rest.norm();
    if (!(length > kLeastNew * functions.col(order[at]).norm())) continue;
    spanned.col(count) = rest / length;
    found.push_back(order[at]);
  }
  while (static_cast<int>(found.size()) < rank) {
    const int count = static_cast<int>(found.size());
    int farthest = 0;
    Eigen::VectorXd most = Eigen::VectorXd::Zero(rank);
    for (int j = 0; j < columns; ++j) {
      const Eigen::VectorXd rest = Outside(spanned, count, functions.col(j));
      if (rest.squaredNorm() > most.squaredNorm()) {
        most = rest;
        farthest = j;
      }
    }
    spanned.col(count) = most.normalized();
    found.push_back(farthest);
  }
  return found;
}

Eigen::VectorXd MovedTarget(const Eigen::VectorXd& target) {
  constexpr double kMove = 1e-9, kGolden = 0.6180339887498949;
  Eigen::VectorXd moved = target;
  for (Eigen::Index j = 0; j < target.size(); ++j) {
    const double turn = static_cast<double>(j + 1) * kGolden;
    moved[j] += kMove * (1 + turn - std::floor(turn));
  }
  return moved;
}

void Refresh(const Eigen::MatrixXd& functions, ActiveColumns& active) {
  const Eigen::MatrixXd square = functions(Eigen::all, active.columns);
  active.inverse = square.partialPivLu().inverse();
}

void Exchange(const Eigen::MatrixXd& functions, int leaving, int entering, ActiveColumns& active) {
  const Eigen::VectorXd shares = active.inverse * functions.col(entering);
  const Eigen::RowVectorXd row = active.inverse.row(leaving) / shares[leaving];
  active.inverse -= shares * row;
  active.inverse.row(leaving) = row;
  active.columns[leaving] = entering;
}

Eigen::VectorXd WeightsAt(const ActiveColumns& active, const Eigen::VectorXd& target) {
  return active.inverse.transpose() * target(active.columns);
}

}  // namespace lfm
