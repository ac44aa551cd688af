// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace lfm {

/// A dense matrix that somebody else holds: `rows` rows of `columns` numbers, `stride` apart.
struct RowsView {
  const float* values = nullptr;
  int64_t rows = 0;
  int columns = 0;
  int64_t stride = 0;

  const float* Row(int64_t row) const { return values + row * stride; }
};

/// Functions over the same directions, one a row: the reflectance functions of pixels (Yamada 2009,
/// R), the rows of a light transport matrix (Mahajan 2007, T), what vertices send to the eyes. Rows
/// are padded with zeros to whole vectors, so that kernels need no remainder.
struct FunctionRows {
  static constexpr int kLane = 16;  ///< floats; the stride is a multiple of it

  int64_t rows = 0;
  int columns = 0;
  int stride = 0;
  std::vector<float> values;  ///< rows x stride

  float* Row(int64_t row) { return values.data() + row * stride; }
  const float* Row(int64_t row) const { return values.data() + row * stride; }
  RowsView View() const { return {values.data(), rows, columns, stride}; }
};

/// All zeros. Throws Error unless rows >= 0, 1 <= columns <= 2^24 and the product is below 2^36.
FunctionRows MakeFunctionRows(int64_t rows, int columns);
/// The rows with these numbers, in this order. Throws Error when one does not exist.
FunctionRows GatherRows(RowsView all, const std::vector<int64_t>& which);
/// The transpose: row j holds column j.
FunctionRows TransposeRows(RowsView matrix);
/// Throws Error, `name` in front, that says where a number stands that is not finite.
void RequireFinite(RowsView matrix, const char* name);

}  // namespace lfm
