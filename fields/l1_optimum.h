// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "fields/function_rows.h"
#include "fields/l1_solver.h"

namespace lfm {

/// The optimum of one row's problem (fields/l1_solver.h) and what proves it. For every y with basis
/// y = 0 and |y_j| <= 1 (kPositive: y_j <= 1), no weights reach an error below sum_j b_j y_j: such
/// a y of equal value is the certificate. Any linear programme's optimum must agree.
struct L1Optimum {
  std::vector<double> weights;  ///< t
  double error = 0;             ///< of these weights
  std::vector<double> dual;     ///< y, a number a column
  double bound = 0;             ///< sum_j b_j y_j
  int steps = 0;                ///< edges that were followed
};

/// By edge descent in float64, from kReweighted's weights. error - bound is below 1e-7 of sum_j
/// |b_j|, |basis y| below 1e-9 of sum_j |basis_j| (1e-5 for functions taken for dependent).
/// `basis` is t x m, t from 0 to 16; `target` holds m numbers. Throws Error when a number is not
/// finite, no weights are feasible (kPositive), or the descent fails.
L1Optimum FindL1Optimum(RowsView basis, const float* target,
                        ResidualSign sign = ResidualSign::kAny);

}  // namespace lfm
