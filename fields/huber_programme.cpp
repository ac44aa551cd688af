// SPDX-License-Identifier: BSD-3-Clause
#include "fields/huber_programme.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace lfm {
namespace {

// x, y and the multipliers of y <= gamma and of y >= -gamma; also a direction of all of them.
struct Point {
  Eigen::VectorXd x, y;
  Eigen::ArrayXd above, below;
};

double Complementarity(const Point& p, double gamma) {
  return (p.above * (gamma - p.y.array()) + p.below * (gamma + p.y.array())).sum() /
         static_cast<double>(2 * p.y.size());
}

// Newton's direction towards above (gamma - y) = below (gamma + y) = aim, all else met.
Point Direction(const Eigen::MatrixXd& functions, const Eigen::VectorXd& target, double gamma,
                const Point& at, double aim) {
  const Eigen::ArrayXd room_above = gamma - at.y.array(), room_below = gamma + at.y.array();
  const Eigen::ArrayXd rest =
      (target - functions.transpose() * at.x - at.y).array() - at.above + at.below;
  const Eigen::ArrayXd correct_above = aim / room_above - at.above;
  const Eigen::ArrayXd correct_below = aim / room_below - at.below;
  const Eigen::ArrayXd inverse = (1 + at.above / room_above + at.below / room_below).inverse();
  const Eigen::ArrayXd wanted = rest - correct_above + correct_below;
  const Eigen::MatrixXd weighted = functions * inverse.matrix().asDiagonal();
  Point step;
  step.x = (weighted * functions.transpose())
               .ldlt()
               .solve(weighted * wanted.matrix() + functions * at.y);
  step.y = (inverse * (wanted - (functions.transpose() * step.x).array())).matrix();
  step.above = correct_above + at.above / room_above * step.y.array();
  step.below = correct_below - at.below / room_below * step.y.array();
  return step;
}

// How far `value` can go by `change` and stay positive, at most 1.
double Room(const Eigen::ArrayXd& value, const Eigen::ArrayXd& change) {
  double most = 1;
  for (Eigen::Index j = 0; j < value.size(); ++j) {
    if (change[j] < 0) most = std::min(most, -value[j] / change[j]);
  }
  return most;
}

double LongestStep(const Point& at, const Point& step, double gamma) {
  const double rooms = std::min(Room(gamma - at.y.array(), -step.y.array()),
                                Room(gamma + at.y.array(), step.y.array()));
  return std::min({rooms, Room(at.above, step.above), Room(at.below, step.below)});
}

Point Moved(const Point& at, const Point& step, double length) {
  return {at.x + length * step.x, at.y + length * step.y, at.above + length * step.above,
          at.below + length * step.below};
}

// sum_j functions_j rho'(r_j), which is zero at the optimum.
Eigen::VectorXd Gradient(const Eigen::MatrixXd& functions, const Eigen::VectorXd& target,
                         double gamma, const Eigen::VectorXd& x) {
  return functions * (target - functions.transpose() * x).cwiseMax(-gamma).cwiseMin(gamma);
}

// Interior points come close; that the residuals within gamma are then known gives the rest.
Eigen::VectorXd Polished(const Eigen::MatrixXd& functions, const Eigen::VectorXd& target,
                         double gamma, Eigen::VectorXd x) {
  constexpr int kMostSteps = 20;
  double objective = HuberObjective(functions, target, gamma, x);
  for (int i = 0; i < kMostSteps; ++i) {
    const Eigen::ArrayXd rest = (target - functions.transpose() * x).array().abs();
    const Eigen::VectorXd within = (rest <= gamma).cast<double>().matrix();
    const Eigen::MatrixXd curvature = functions * within.asDiagonal() * functions.transpose();
    const Eigen::VectorXd next = x + curvature.completeOrthogonalDecomposition().solve(
                                         Gradient(functions, target, gamma, x));
    const double there = HuberObjective(functions, target, gamma, next);
    if (!(there < objective)) break;
    objective = there;
    x = next;
  }
  return x;
}

}  // namespace

Eigen::VectorXd SolveHuberProgramme(const Eigen::MatrixXd& functions, const Eigen::VectorXd& target,
                                    double gamma) {
  constexpr int kMostSteps = 100;
  constexpr double kBackOff = 0.995, kTolerance = 1e-9;
  if (functions.rows() == 0) return Eigen::VectorXd(0);
  Point at;
  at.x = (functions * functions.transpose()).ldlt().solve(functions * target);
  at.y = Eigen::VectorXd::Zero(target.size());
  const Eigen::ArrayXd rest = (target - functions.transpose() * at.x).array();
  at.above = rest.max(0) + gamma;
  at.below = (-rest).max(0) + gamma;
  const double finest = kTolerance * gamma * gamma;
  for (int i = 0; i < kMostSteps && Complementarity(at, gamma) > finest; ++i) {
    // Where full steps lead without a barrier says how far to lower it (Mehrotra 1992).
    const Point straight = Direction(functions, target, gamma, at, 0);
    const double now = Complementarity(at, gamma);
    const double ahead =
        Complementarity(Moved(at, straight, kBackOff * LongestStep(at, straight, gamma)), gamma);
    const double aim = now * std::pow(ahead / now, 3);
    const Point step = Direction(functions, target, gamma, at, aim);
    at = Moved(at, step, kBackOff * LongestStep(at, step, gamma));
  }
  const Eigen::VectorXd x = Polished(functions, target, gamma, at.x);
  // The objective is convex: a small slope bounds what is left to gain.
  const double allowed = 1e-6 * gamma * functions.cwiseAbs().sum();
  if (!(Gradient(functions, target, gamma, x).cwiseAbs().maxCoeff() <= allowed)) {
    throw Error("the quadratic programme was not solved", ErrorKind::kSystem);
  }
  return x;
}

double HuberObjective(const Eigen::MatrixXd& functions, const Eigen::VectorXd& target, double gamma,
                      const Eigen::VectorXd& weights) {
  const Eigen::ArrayXd rest = (target - functions.transpose() * weights).array().abs();
  return (rest <= gamma).select(rest.square() / 2, gamma * rest - gamma * gamma / 2).sum();
}

}  // namespace lfm
