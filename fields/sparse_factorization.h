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

/// Alternates: all rows of W with F fixed, then all columns of F with W fixed, each an L1 problem
/// of its own. Basis functions are scaled to unit L2 norm. A matrix of zeros gives no terms; more
/// terms than min(n, m) are cut to that.
SparseFactors FactorizeSparse(RowsView r, const SparseFactorizationOptions& options);

}  // namespace lfm
