// SPDX-License-Identifier: BSD-3-Clause
#include "fields/l1_edge_descent.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "fields/active_columns.h"

namespace lfm {
namespace {

struct Breakpoint {
  double step, turn;  // the slope grows by twice `turn` there
  int column;
};

// The nearest first; of equal ones the column of the lower number.
bool IsFarther(const Breakpoint& a, const Breakpoint& b) {
  return a.step > b.step || (a.step == b.step && a.column > b.column);
}

// The column at which the error along the edge, falling by -slope, starts to rise; -1 if none.
int WeightedMedian(std::vector<Breakpoint>& breakpoints, double slope) {
  std::make_heap(breakpoints.begin(), breakpoints.end(), IsFarther);
  auto end = breakpoints.end();
  while (end != breakpoints.begin()) {
    std::pop_heap(breakpoints.begin(), end, IsFarther);
    --end;
    slope += 2 * end->turn;
    if (slope >= 0) return end->column;
  }
  return -1;
}

// Residuals at the active columns' weights, there exactly zero.
Eigen::VectorXd ResidualsAt(const Eigen::MatrixXd& functions, const ActiveColumns& active,
                            const Eigen::VectorXd& target) {
  Eigen::VectorXd rest = target;
  rest.noalias() -= functions.transpose() * WeightsAt(active, target);
  for (int column : active.columns) rest[column] = 0;
  return rest;
}

Eigen::VectorXd DualAt(const Eigen::MatrixXd& functions, const ActiveColumns& active,
                       const Eigen::VectorXd& rest) {
  Eigen::VectorXd dual = rest.cwiseSign();
  const Eigen::VectorXd pull = active.inverse * (functions * dual);
  for (size_t i = 0; i < active.columns.size(); ++i) dual[active.columns[i]] = -pull[i];
  return dual;
}

}  // namespace

std::optional<L1Vertex> DescendEdges(const Eigen::MatrixXd& functions,
                                     const Eigen::VectorXd& target, const Eigen::VectorXd& start) {
  constexpr double kOptimal = 1e-9, kParallel = 1e-11;
  const Eigen::VectorXd moved = MovedTarget(target);
  ActiveColumns active;
  active.columns =
      IndependentColumns(functions, (target - functions.transpose() * start).cwiseAbs());
  Refresh(functions, active);
  std::vector<Breakpoint> breakpoints;
  bool fresh = true;
  const int most_steps = 100 + 20 * static_cast<int>(target.size());
  for (int steps = 0; steps < most_steps; ++steps) {
    const Eigen::VectorXd rest = ResidualsAt(functions, active, moved);
    const Eigen::VectorXd dual = DualAt(functions, active, rest);
    Eigen::Index leaving = 0;
    const double most =
        active.columns.empty() ? 0 : dual(active.columns).cwiseAbs().maxCoeff(&leaving);
    if (most <= 1 + kOptimal) {
      if (fresh) {
        return L1Vertex{WeightsAt(active, target), dual.cwiseMax(-1.0).cwiseMin(1.0), steps};
      }
      Refresh(functions, active);
      fresh = true;
      continue;
    }
    Eigen::VectorXd edge = active.inverse.row(leaving).transpose();
    if (dual[active.columns[leaving]] > 0) edge = -edge;
    const Eigen::VectorXd change = functions.transpose() * edge;
    breakpoints.clear();
    for (Eigen::Index j = 0; j < rest.size(); ++j) {
      if (change[j] * rest[j] <= 0 || std::abs(change[j]) < kParallel * edge.norm()) continue;
      breakpoints.push_back({rest[j] / change[j], std::abs(change[j]), static_cast<int>(j)});
    }
    const int entering = WeightedMedian(breakpoints, 1 - most);
    if (entering < 0) return std::nullopt;
    Exchange(functions, static_cast<int>(leaving), entering, active);
    fresh = false;
  }
  return std::nullopt;
}

}  // namespace lfm
