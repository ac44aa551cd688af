// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "fields/function_rows.h"

namespace lfm {

/// The dimensionality of a set of rows (Mahajan 2007, Section 3): how many eigenvalues of rows
/// rows^T hold `share` (0 to 1) of their sum; the mean is not subtracted (footnote 2). The paper
/// takes 99.95 % for patches in 3D, 99.9 % in flatland and for N.
///
/// `expected` is what it may be near: it changes the time, not the answer. In float64 where the
/// smaller side is short; else by subspaces that catch the share (fields/matrix_terms.h), which may
/// count a term more among hundreds where eigenvalues are nearly equal. 0 without rows or energy.
/// Throws Error when a number is not finite or the share out of range.
int DimensionOf(RowsView rows, double share, int expected = 0);

/// The same of eigenvalues that are known, largest first; negative ones (rounding) count as 0.
int DimensionOf(const std::vector<double>& eigenvalues, double share);

}  // namespace lfm
