// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace lfm {

/// Weights x of least sum_j rho(b_j - (x functions)_j) with Huber's rho (Yamada 2009, Equation 9):
/// r^2 / 2 up to |r| = gamma, gamma |r| - gamma^2 / 2 beyond.
///
/// The quadratic programme of Equations 12 and 13 by a primal-dual interior point method on its
/// dual, which has a variable a column instead of two:
///
///   max b.y - |y|^2 / 2  s.t.  functions y = 0, |y_j| <= gamma
///
/// whose y is the paper's E; then Newton's method for the residuals that are within gamma.
/// `functions` are independent, numbers about 1, gamma > 0. Throws Error when rounding leaves a
/// slope |sum_j functions_j rho'(r_j)| above 1e-6 gamma sum |functions|.
Eigen::VectorXd SolveHuberProgramme(const Eigen::MatrixXd& functions, const Eigen::VectorXd& target,
                                    double gamma);

/// sum_j rho(b_j - (x functions)_j)
double HuberObjective(const Eigen::MatrixXd& functions, const Eigen::VectorXd& target, double gamma,
                      const Eigen::VectorXd& weights);

}  // namespace lfm
