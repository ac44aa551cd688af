// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "fields/function_rows.h"
#include "fields/l1_kernels.h"
#include "fields/l1_solver.h"

namespace lfm {

/// SolveL1 by L1Solver::kReweighted with these kernels: float32, a row a vector lane. The basis has
/// 16 functions at most. A `start` (n x t, or empty) is never left for worse, in float64.
L1Solution SolveReweighted(RowsView basis, RowsView targets, int iterations,
                           const std::vector<float>& start, const kernels::L1Kernels& kernels);

}  // namespace lfm
