// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "fields/function_rows.h"

namespace lfm {

/// The best subspace for each row and how much of it that holds.
struct RowAssignment {
  std::vector<int> cluster;
  std::vector<double> held;  ///< squared length of the projection
};

/// Assigns every row to the basis (orthonormal functions, a cluster each; none is allowed) that
/// holds most of it. A row stays in its cluster of `before` (empty: none) unless another holds more
/// by 1e-6 of its energy; else ties go to the lower number.
RowAssignment AssignRows(RowsView rows, const std::vector<double>& energies,
                         const std::vector<FunctionRows>& bases, const std::vector<int>& before);

/// Rows to begin clusters with, at most `count`: each is drawn by the energy that the lines through
/// those before it leave, by a fixed sequence. Fewer when nothing is left over.
std::vector<int64_t> SeedRows(RowsView rows, const std::vector<double>& energies, int count);

}  // namespace lfm
