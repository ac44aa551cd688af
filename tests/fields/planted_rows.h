// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "fields/function_rows.h"

namespace lfm {

/// Rows of known clusters: cluster c's rows are random combinations of `terms` random functions of
/// its own, with `bias` more of the first; clusters take turns row by row.
inline FunctionRows PlantedRows(int clusters, int rows_each, int terms, int columns, uint32_t seed,
                                double scale = 1, double bias = 0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<std::vector<double>> functions(static_cast<size_t>(clusters * terms));
  for (std::vector<double>& function : functions) {
    for (int j = 0; j < columns; ++j) function.push_back(normal(random));
  }
  FunctionRows rows = MakeFunctionRows(int64_t{clusters} * rows_each, columns);
  for (int64_t row = 0; row < rows.rows; ++row) {
    std::vector<double> sum(static_cast<size_t>(columns));
    for (int t = 0; t < terms; ++t) {
      const double weight = normal(random) + (t == 0 ? bias : 0);
      const std::vector<double>& function = functions[row % clusters * terms + t];
      for (int j = 0; j < columns; ++j) sum[j] += weight * function[j];
    }
    for (int j = 0; j < columns; ++j) rows.Row(row)[j] = static_cast<float>(scale * sum[j]);
  }
  return rows;
}

/// Shadow edges that move over `columns` directions as a row goes on: row i is 1 up to direction i
/// and 0 beyond. The dimensionality of consecutive rows is their number (Mahajan 2007, Figure 5b).
inline FunctionRows StepRows(int rows, int columns) {
  FunctionRows steps = MakeFunctionRows(rows, columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j <= i && j < columns; ++j) steps.Row(i)[j] = 1;
  }
  return steps;
}

}  // namespace lfm
