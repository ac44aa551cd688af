// SPDX-License-Identifier: BSD-3-Clause
#include "fields/function_rows.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"

namespace lfm {

FunctionRows MakeFunctionRows(int64_t rows, int columns) {
  constexpr int64_t kMostColumns = int64_t{1} << 24, kMostValues = int64_t{1} << 36;
  if (rows < 0 || columns < 1 || columns > kMostColumns || rows > kMostValues / columns) {
    throw Error("a matrix of " + std::to_string(rows) + " x " + std::to_string(columns) +
                " numbers is out of range");
  }
  FunctionRows result;
  result.rows = rows;
  result.columns = columns;
  result.stride = (columns + FunctionRows::kLane - 1) / FunctionRows::kLane * FunctionRows::kLane;
  result.values.resize(static_cast<size_t>(rows) * result.stride);
  return result;
}

FunctionRows GatherRows(RowsView all, const std::vector<int64_t>& which) {
  FunctionRows result = MakeFunctionRows(static_cast<int64_t>(which.size()), all.columns);
  for (int64_t i = 0; i < result.rows; ++i) {
    if (which[i] < 0 || which[i] >= all.rows) {
      throw Error("row " + std::to_string(which[i]) + " is not among the " +
                  std::to_string(all.rows) + " rows");
    }
    std::copy_n(all.Row(which[i]), all.columns, result.Row(i));
  }
  return result;
}

FunctionRows TransposeRows(RowsView matrix) {
  // Tiles keep both matrices' lines in the cache.
  constexpr int64_t kTile = 32;
  FunctionRows result = MakeFunctionRows(matrix.columns, static_cast<int>(matrix.rows));
  for (int64_t row = 0; row < matrix.rows; row += kTile) {
    const int64_t row_end = std::min(row + kTile, matrix.rows);
    for (int64_t column = 0; column < matrix.columns; column += kTile) {
      const int64_t column_end = std::min<int64_t>(column + kTile, matrix.columns);
      for (int64_t c = column; c < column_end; ++c) {
        for (int64_t r = row; r < row_end; ++r) result.Row(c)[r] = matrix.Row(r)[c];
      }
    }
  }
  return result;
}

void RequireFinite(RowsView matrix, const char* name) {
  for (int64_t row = 0; row < matrix.rows; ++row) {
    const float* values = matrix.Row(row);
    for (int column = 0; column < matrix.columns; ++column) {
      if (!std::isfinite(values[column])) {
        throw Error(std::string(name) + ": row " + std::to_string(row) + ", column " +
                    std::to_string(column) + " is not finite");
      }
    }
  }
}

}  // namespace lfm
