// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "fields/function_rows.h"
#include "fields/l1_solver.h"

namespace lfm {

/// Where the alternation begins.
enum class FactorStart {
  kPca,     ///< the first t right singular vectors
  kRandom,  ///< random numbers with a fixed seed, as the paper
};

struct SparseFactorizationOptions {
  int terms = 4;  ///< t
  FactorStart start = FactorStart::kPca;
  int max_alternations = 20;
  double tolerance = 1e-4;  ///< stop when the L1 error falls by less, relative to it
  L1Options l1;
};

/// R ~ W F with as sparse a residual as can be (Yamada 2009, Section 3.2, Equations 4 to 7).
struct SparseFactors {
  FunctionRows basis;            ///< F, t x m; fewer rows where the rank is less
  std::vector<float> weights;    ///< W, n x t
  std::vector<double> l1_error;  ///< after the start, then after each alternation; never rises
};

/// Alternates: all columns of F with W fixed, then all rows of W with F fixed, each an L1 problem
/// of its own that starts where the last one ended. Stops early when the error does not fall.
/// Basis functions have unit L2 norm. A matrix of zeros gives no terms; more terms than min(n, m)
/// are cut to that; terms that nothing uses are dropped.
///
/// 500 x 253, 4 terms, one thread (lfm-bench-l1): a low rank with 10 % spikes takes 3 alternations
/// from PCA, 4 from random, 25 ms, and leaves 90 % of the residual below 1e-3; rows like
/// reflectance functions take 12 and 75 ms (0.4 s with kExact, to the same error within 2e-5).
///
/// Throws Error unless 0 <= terms <= 16, numbers are finite, and with ResidualSign::kPositive when
/// negative numbers leave no feasible weights.
SparseFactors FactorizeSparse(RowsView r, const SparseFactorizationOptions& options);

}  // namespace lfm
