// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace lfm {

enum class ClpForm {
  kPrimal,  ///< Yamada 2009, Equation 8: a constraint a column
  kDual     ///< max b.y with functions y = 0, |y_j| <= 1: a constraint a function
};

/// The least sum_j |b_j - (x functions)_j| by Clp, a second opinion beside GLPK's.
double LeastErrorByClp(const Eigen::MatrixXd& functions, const Eigen::VectorXd& target,
                       ClpForm form);

}  // namespace lfm
