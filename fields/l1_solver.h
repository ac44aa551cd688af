// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "fields/function_rows.h"

namespace lfm {

/// What finds the weights of least absolute error (Yamada 2009, Section 3.2).
enum class L1Solver {
  kReweighted,          ///< iteratively reweighted least squares in float32: the default
  kExact,               ///< the same, then edge descent in float64 to the optimum itself
  kLinearProgramme,     ///< the paper's linear programme (Equation 8), by GLPK
  kQuadraticProgramme,  ///< the paper's quadratic programme of Huber's estimator (9 to 13)
};

/// Of which sign the residual may be.
enum class ResidualSign {
  kAny,
  /// W F <= R everywhere, up to rounding of the weights (the paper's remark on dropping the term
  /// l). Solved to the optimum in float64: by GLPK for kLinearProgramme, else by edge descent
  /// within the feasible set; a start does not count.
  kPositive,
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
/// `basis` is t x m, t from 0 to 16 (64 for the two programmes). `start` (n x t, or empty) is where
/// the search begins; it is never left for a greater error. Parallel over rows; the result does
/// not depend on the number of threads, nor on which rows are solved together.
///
/// What 500 rows of 253 numbers, 4 functions, cost and reach (lfm-bench-l1, AVX2, one thread):
///   kReweighted, 10 / 20 / 30 iterations: 2.8 / 4.5 / 6.2 microseconds a row; objective 3e-4 /
///   2e-5 / 4e-6 above the optimum on a low rank with 10 % spikes, 1e-3 / 2e-4 / 4e-5 on rows like
///   reflectance functions. Time is linear in m; 2.5 x at 8 functions, 9 x at 16.
///   kExact: 35 to 50 microseconds; the optimum up to float32 rounding of the weights.
///   kQuadraticProgramme: 0.3 to 0.6 ms. kLinearProgramme: 7 to 9 ms, quadratic in m.
/// A row whose largest number is 1e6 times the others loses sparseness with kReweighted: what it
/// takes for zero is 1e-4 of the mean residual. kExact knows no such limit.
///
/// Extremes: a zero row gives zero weights; zero, repeated or dependent basis functions (less than
/// 1e-5 new) get no weight, never NaN; magnitudes may lie anywhere in 1e+-25; m <= t interpolates.
/// Throws Error when sizes do not fit, a number is not finite, a weight leaves float32's range
/// (targets of 1e25 over a basis of 1e-25), no weights leave a positive residual (none are needed
/// where targets are not negative), or a positive residual is asked of kQuadraticProgramme.
L1Solution SolveL1(RowsView basis, RowsView targets, const L1Options& options,
                   const std::vector<float>& start = {});

/// sum over all entries of |targets - weights basis|, in float64.
double L1Error(RowsView basis, const std::vector<float>& weights, RowsView targets);

}  // namespace lfm
