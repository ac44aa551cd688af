// SPDX-License-Identifier: BSD-3-Clause
#include "fields/huber_programme.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numeric>

#include "tests/fields/l1_problems.h"

namespace lfm {
namespace {

// Reweighted least squares of Huber's estimator: monotone, slow, and another way altogether.
Eigen::VectorXd ByReweighting(const Eigen::MatrixXd& functions, const Eigen::VectorXd& target,
                              double gamma) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(functions.rows());
  for (int i = 0; i < 5000; ++i) {
    const Eigen::ArrayXd rest = (target - functions.transpose() * x).array().abs();
    const Eigen::ArrayXd weight = (rest > gamma).select(gamma / rest, 1.0);
    const Eigen::MatrixXd weighted = functions * weight.matrix().asDiagonal();
    x = (weighted * functions.transpose()).ldlt().solve(weighted * target);
  }
  return x;
}

TEST(HuberProgramme, AgreesWithReweighting) {
  for (const double gamma : {1e-3, 0.05, 0.5}) {
    for (uint32_t seed = 0; seed < 8; ++seed) {
      const Eigen::MatrixXd functions = ToDense(MakeNoise(3, 30, seed).View());
      const Eigen::VectorXd target = ToDense(MakeNoise(1, 30, 50 + seed).View()).row(0);
      const Eigen::VectorXd found = SolveHuberProgramme(functions, target, gamma);
      const double objective = HuberObjective(functions, target, gamma, found);
      const double other =
          HuberObjective(functions, target, gamma, ByReweighting(functions, target, gamma));
      EXPECT_LE(objective, other * (1 + 1e-9));
      EXPECT_NEAR(objective, other, 2e-3 * other) << gamma;
    }
  }
}

TEST(HuberProgramme, AgreesWithTryingAlongALine) {
  for (uint32_t seed = 0; seed < 20; ++seed) {
    const Eigen::MatrixXd functions = ToDense(MakeNoise(1, 11, seed).View());
    const Eigen::VectorXd target = ToDense(MakeNoise(1, 11, 70 + seed).View()).row(0);
    const auto objective = [&](double x) {
      return HuberObjective(functions, target, 0.1, Eigen::VectorXd::Constant(1, x));
    };
    double least = -20, most = 20;
    for (int i = 0; i < 200; ++i) {
      const double left = least + (most - least) / 3, right = most - (most - least) / 3;
      (objective(left) < objective(right) ? most : least) =
          objective(left) < objective(right) ? right : left;
    }
    EXPECT_NEAR(SolveHuberProgramme(functions, target, 0.1)[0], least, 1e-6);
  }
}

TEST(HuberProgramme, AWideGammaIsLeastSquares) {
  const Eigen::MatrixXd functions = ToDense(MakeNoise(4, 40, 1).View());
  const Eigen::VectorXd target = ToDense(MakeNoise(1, 40, 2).View()).row(0);
  const Eigen::VectorXd squares = functions.transpose().colPivHouseholderQr().solve(target);
  EXPECT_LT((SolveHuberProgramme(functions, target, 100) - squares).norm(), 1e-9);
}

TEST(HuberProgramme, ANarrowGammaIsNearTheLeastAbsoluteError) {
  const SpikedLowRank problem = MakeSpikedLowRank(10, 120, 4, 0.2, 3);
  L1Options options;
  options.solver = L1Solver::kExact;
  const L1Solution best = SolveL1(problem.basis.View(), problem.matrix.View(), options);
  options.solver = L1Solver::kQuadraticProgramme;
  double before = 1e30;
  for (const double gamma : {0.3, 0.03, 0.003}) {
    options.huber_gamma = gamma;
    const L1Solution found = SolveL1(problem.basis.View(), problem.matrix.View(), options);
    const double excess = std::accumulate(found.errors.begin(), found.errors.end(), 0.0) -
                          std::accumulate(best.errors.begin(), best.errors.end(), 0.0);
    EXPECT_GE(excess, -1e-5);
    EXPECT_LT(excess, before / 2);
    before = excess;
  }
}

}  // namespace
}  // namespace lfm
