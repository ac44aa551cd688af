// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "fields/function_rows.h"

namespace lfm {

/// The rows R of a field as clusters with a basis each, and what is left over (Yamada 2009,
/// Equation 2; without residual, clustered PCA: Sloan 2003, Mahajan 2007 Equation 2):
///
///   R_r = sum_t weight[r][t] basis[cluster[r]][t] + residual_r
///
/// Weights of row r lie at `weights[first_weight[r]]`, as many as its cluster has terms. The
/// residual of row r lies at `first_residual[r]` to `first_residual[r + 1]`, largest magnitude
/// first, so that any number of leading entries is the best choice of that many.
struct ClusteredModel {
  int64_t rows = 0;
  int columns = 0;
  std::vector<uint16_t> cluster;      ///< a row
  std::vector<FunctionRows> bases;    ///< a cluster: terms x columns; may have no rows
  std::vector<int64_t> first_weight;  ///< a row
  std::vector<float> weights;
  std::vector<int64_t> first_residual;  ///< rows + 1; empty: no residual
  std::vector<uint16_t> residual_column;
  std::vector<float> residual_value;

  int Terms(int64_t row) const { return static_cast<int>(bases[cluster[row]].rows); }
};

/// Throws Error when sizes, cluster numbers or columns do not fit together, a basis has more
/// functions or a row more residuals than there are columns, or a number is not finite.
void CheckModel(const ClusteredModel& model);

/// Row `row` with its first `residuals` residual entries (-1: all), into `out` (columns floats).
void EvaluateRow(const ClusteredModel& model, int64_t row, int residuals, float* out);

/// The mean over rows of |R - model|^2 / |R|^2 (Yamada 2009, Equation 16) with the first
/// `residuals` residual entries of each row (-1: all), in float64. Rows without energy do not
/// count; without any other the error is 0. `which`: the rows that count; empty: all.
double RelativeError(const ClusteredModel& model, RowsView truth, int residuals,
                     const std::vector<int64_t>& which = {});

}  // namespace lfm
