// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "fields/l1_solver.h"

namespace lfm {

/// Weights x of least sum_j |b_j - (x functions)_j| by the linear programme of Yamada 2009,
/// Equation 8, with GLPK's simplex method: variables x, k, l with functions^T x + k - l = b, k, l
/// >= 0, of least sum k + l; without l for a positive residual. Numbers should be about 1. The
/// oracle of the other solvers: time grows with the square of the columns. None when no weights are
/// feasible (kPositive only). Throws Error when GLPK gives up.
std::optional<Eigen::VectorXd> SolveLinearProgramme(const Eigen::MatrixXd& functions,
                                                    const Eigen::VectorXd& target,
                                                    ResidualSign sign);

}  // namespace lfm
