// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fields/function_rows.h"

namespace lfm {

/// Products of dense matrices in the widest vectors that the machine has. Parallel over fixed tiles
/// of the result, which therefore does not depend on the number of threads. Inputs must be finite;
/// sizes that do not fit throw Error. Float32 sums are flushed every 128 terms; float64 sums are of
/// exact products.

/// a b^T: element (i, j) is the dot product of row i of a and row j of b.
FunctionRows TimesTransposed(RowsView a, RowsView b);
/// a b.
FunctionRows Times(RowsView a, RowsView b);
/// a^T b.
FunctionRows TransposedTimes(RowsView a, RowsView b);
/// a^T b in float64.
Eigen::MatrixXd TransposedTimes(const Eigen::MatrixXd& a, RowsView b);

/// a a^T and a^T a in float64, symmetric to the bit.
Eigen::MatrixXd GramOfRows(RowsView a);
Eigen::MatrixXd GramOfColumns(RowsView a);

/// The sum of squares of all entries, in float64.
double EnergyOf(RowsView a);
/// The same for every row.
std::vector<double> RowEnergies(RowsView a);

}  // namespace lfm
