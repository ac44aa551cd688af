// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "fields/function_rows.h"

namespace lfm {

/// What finds the weights of least absolute error (Yamada 2009, Section 3.2).
enum class L1Solver {
  kReweighted,         ///< iteratively reweighted least squares in float32: the default
  kExact,              ///< the same, then edge descent in float64 to the optimum itself
  kLinearProgramme,    ///< the paper's linear programme (Equation 8), by GLPK
  kQuadraticProgramme  ///< the paper's quadratic programme of Huber's estimator (Equations 9 to 13)
};

/// Of which sign the residual may be.
enum class ResidualSign {
  kAny,
  kPositive,  ///< W F <= R everywhere (the paper's remark on dropping the term l)
};

struct L1Options {
  L1Solver solver = L1Solver::kReweighted;
  ResidualSign sign = ResidualSign::kAny;
  int iterations = 20;        ///< of kReweighted, and before kExact descends
  double huber_gamma = 1e-3;  ///< of kQuadraticProgramme, relative to the row's mean magnitude
};

struct L1Solution {
  std::vector<float> weights;  ///< n x t, row-major
  /// A row: sum_j |b_j - sum_t x_t basis[t][j]| with the weights as they stand here, float64.
  std::vector<double> errors;
};

/// For each row b of `targets` (n x m) the weights x (t numbers) that minimise
///
///   sum_j |b_j - sum_t x_t basis[t][j]|                                    (Equation 7)
///
/// `basis` is t x m, t from 0 to 16 (64 for the reference solvers). `start` (n x t, or empty) is
/// where the search begins; it is never left for a greater error. Parallel over rows; the result
/// does not depend on the number of threads.
///
/// kReweighted: objective within 0.1 % of the optimum on the data of the tests, 0.01 % typically.
/// Extremes: a zero row gives zero weights; zero, repeated or dependent basis functions share the
/// weight or get none, never NaN; magnitudes may lie anywhere in 1e+-25; m < t interpolates.
/// Throws Error when sizes do not fit, a number is not finite, or a weight leaves float32's range
/// (targets of 1e25 over a basis of 1e-25).
L1Solution SolveL1(RowsView basis, RowsView targets, const L1Options& options,
                   const std::vector<float>& start = {});

/// sum over all entries of |targets - weights basis|, in float64.
double L1Error(RowsView basis, const std::vector<float>& weights, RowsView targets);

}  // namespace lfm
