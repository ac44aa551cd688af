// SPDX-License-Identifier: BSD-3-Clause
// A linear programme in few variables with a constraint a column: max gain.x with functions^T x <=
// target. Constraints are moved outwards by 1e-9, each by another amount, so that no vertex meets
// more of them than it must and every step gains.
#include "fields/l1_one_sided.h"

#include <Eigen/Dense>
#include <limits>
#include <vector>

#include "core/error.h"
#include "fields/active_columns.h"

namespace lfm {
namespace {

struct Climb {
  ActiveColumns active;
  Eigen::VectorXd multipliers;  // of the active constraints
  int steps = 0;
};

struct Block {
  int column = -1;
  double step = std::numeric_limits<double>::infinity();
};

// The first constraint met from `x` along `direction`.
Block FirstBlock(const Eigen::MatrixXd& functions, const Eigen::VectorXd& rest,
                 const Eigen::VectorXd& direction, const std::vector<int>& active) {
  constexpr double kParallel = 1e-11;
  Eigen::VectorXd change = functions.transpose() * direction;
  for (int column : active) change[column] = 0;
  Block block;
  for (Eigen::Index j = 0; j < rest.size(); ++j) {
    if (change[j] <= kParallel * direction.norm()) continue;
    const double step = std::max(rest[j], 0.0) / change[j];
    if (step < block.step) block = {static_cast<int>(j), step};
  }
  return block;
}

// From a feasible point uphill, or on the level, until as many constraints as variables are met.
ActiveColumns VertexFrom(const Eigen::MatrixXd& functions, const Eigen::VectorXd& target,
                         const Eigen::VectorXd& gain, Eigen::VectorXd x) {
  const Eigen::Index rank = functions.rows();
  Eigen::MatrixXd spanned(rank, rank);
  ActiveColumns active;
  while (static_cast<Eigen::Index>(active.columns.size()) < rank) {
    const Eigen::Index count = static_cast<Eigen::Index>(active.columns.size());
    const auto outside = [&](const Eigen::VectorXd& v) -> Eigen::VectorXd {
      const Eigen::VectorXd once =
          v - spanned.leftCols(count) * (spanned.leftCols(count).transpose() * v);
      return once - spanned.leftCols(count) * (spanned.leftCols(count).transpose() * once);
    };
    Eigen::VectorXd direction = outside(gain);
    const bool level = direction.norm() <= 1e-9 * gain.norm();
    for (Eigen::Index k = 0; level && k < rank; ++k) {
      const Eigen::VectorXd other = outside(Eigen::VectorXd::Unit(rank, k));
      if (k == 0 || other.norm() > direction.norm()) direction = other;
    }
    direction.normalize();
    const Eigen::VectorXd rest = target - functions.transpose() * x;
    Block block = FirstBlock(functions, rest, direction, active.columns);
    if (block.column < 0) {
      direction = -direction;
      block = FirstBlock(functions, rest, direction, active.columns);
    }
    if (block.column < 0) {
      throw Error("one-sided L1: functions that depend on each other", ErrorKind::kSystem);
    }
    x += block.step * direction;
    spanned.col(count) = outside(functions.col(block.column)).normalized();
    active.columns.push_back(block.column);
  }
  Refresh(functions, active);
  return active;
}

std::optional<Climb> ClimbToTop(const Eigen::MatrixXd& functions, const Eigen::VectorXd& target,
                                const Eigen::VectorXd& gain, const Eigen::VectorXd& feasible) {
  constexpr double kOptimal = 1e-9;
  Climb climb;
  climb.active = VertexFrom(functions, target, gain, feasible);
  const double scale = std::max(gain.cwiseAbs().maxCoeff(), 1.0);
  const int most_steps = 100 + 20 * static_cast<int>(target.size());
  for (bool fresh = true; climb.steps < most_steps; ++climb.steps) {
    climb.multipliers = climb.active.inverse * gain;
    Eigen::Index leaving;
    if (climb.multipliers.minCoeff(&leaving) >= -kOptimal * scale) {
      if (fresh) return climb;
      Refresh(functions, climb.active);
      fresh = true;
      continue;
    }
    const Eigen::VectorXd edge = -climb.active.inverse.row(leaving).transpose();
    const Eigen::VectorXd rest = target - functions.transpose() * WeightsAt(climb.active, target);
    const Block block = FirstBlock(functions, rest, edge, climb.active.columns);
    if (block.column < 0) return std::nullopt;
    Exchange(functions, static_cast<int>(leaving), block.column, climb.active);
    fresh = false;
  }
  return std::nullopt;
}

// Weights that violate no constraint: one more variable is what all constraints are relaxed by.
std::optional<Eigen::VectorXd> FeasibleWeights(const Eigen::MatrixXd& functions,
                                               const Eigen::VectorXd& target) {
  const Eigen::Index rank = functions.rows(), columns = functions.cols();
  if (target.minCoeff() >= 0) return Eigen::VectorXd::Zero(rank);
  Eigen::MatrixXd relaxed = Eigen::MatrixXd::Zero(rank + 1, columns + 1);
  relaxed.topLeftCorner(rank, columns) = functions;
  relaxed.row(rank).setConstant(-1);
  Eigen::VectorXd bounds(columns + 1);
  bounds << target, 0;
  Eigen::VectorXd start = Eigen::VectorXd::Zero(rank + 1);
  start[rank] = -target.minCoeff();
  const Eigen::VectorXd gain = -Eigen::VectorXd::Unit(rank + 1, rank);
  const std::optional<Climb> climb = ClimbToTop(relaxed, bounds, gain, start);
  if (!climb) return std::nullopt;
  const Eigen::VectorXd top = WeightsAt(climb->active, bounds);
  // The constraints were moved outwards by more than this.
  if (top[rank] > 0.5e-9) return std::nullopt;
  return Eigen::VectorXd(top.head(rank));
}

}  // namespace

std::optional<L1Vertex> DescendOneSided(const Eigen::MatrixXd& functions,
                                        const Eigen::VectorXd& target) {
  const Eigen::VectorXd moved = MovedTarget(target);
  const std::optional<Eigen::VectorXd> feasible = FeasibleWeights(functions, moved);
  if (!feasible) return std::nullopt;
  if (functions.rows() == 0) {
    return L1Vertex{Eigen::VectorXd(0), Eigen::VectorXd::Ones(target.size()), 0};
  }
  const Eigen::VectorXd gain = functions.rowwise().sum();
  const std::optional<Climb> climb = ClimbToTop(functions, moved, gain, *feasible);
  if (!climb) return std::nullopt;
  L1Vertex vertex{WeightsAt(climb->active, target), Eigen::VectorXd::Ones(target.size()),
                  climb->steps};
  for (size_t i = 0; i < climb->active.columns.size(); ++i) {
    vertex.dual[climb->active.columns[i]] = 1 - climb->multipliers[static_cast<Eigen::Index>(i)];
  }
  return vertex;
}

}  // namespace lfm
