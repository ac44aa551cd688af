// SPDX-License-Identifier: BSD-3-Clause
#include "fields/matrix_products.h"

#include <algorithm>
#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/matrix_kernels.h"

namespace lfm {
namespace {

using kernels::Factor;

Factor<float> AsIs(RowsView a) { return {a.values, a.stride, 1}; }
Factor<float> Transposed(RowsView a) { return {a.values, 1, a.stride}; }

enum class Tiles { kAll, kUpper };  // kUpper: those on and above the diagonal

template <typename Number>
struct Result {
  Number* values;
  int64_t rows, columns, step;
};

template <typename From, typename Number>
void AddInTiles(const Factor<From>& a, const Factor<float>& b, int64_t depth,
                const Result<Number>& c, Tiles which) {
  // Small results are cut finer, so that there is work for a few threads.
  constexpr int64_t kTile = kernels::kProductTile;
  const int64_t tile = std::max(c.rows, c.columns) > 4 * kTile ? kTile : kTile / 2;
  const int64_t across = (c.columns + tile - 1) / tile, down = (c.rows + tile - 1) / tile;
  ParallelFor(0, across * down, [&](int64_t index) {
    const int64_t row = index / across * tile, column = index % across * tile;
    if (which == Tiles::kUpper && column < row) return;
    std::vector<Number> workspace(kernels::kProductWorkspace);
    const Factor<From> rows_of_a = {a.values + row * a.row_step, a.row_step, a.column_step};
    const Factor<float> columns_of_b = {b.values + column * b.column_step, b.row_step,
                                        b.column_step};
    kernels::AddProduct(rows_of_a, columns_of_b, static_cast<int>(std::min(tile, c.rows - row)),
                        depth, static_cast<int>(std::min(tile, c.columns - column)),
                        c.values + row * c.step + column, c.step, workspace.data());
  });
}

FunctionRows Product(const Factor<float>& a, const Factor<float>& b, int64_t rows, int64_t depth,
                     int64_t columns) {
  FunctionRows c = MakeFunctionRows(rows, static_cast<int>(columns));
  AddInTiles(a, b, depth, Result<float>{c.values.data(), rows, columns, c.stride}, Tiles::kAll);
  return c;
}

Eigen::MatrixXd Gram(const Factor<float>& left, const Factor<float>& right, int64_t size,
                     int64_t depth) {
  Eigen::MatrixXd g = Eigen::MatrixXd::Zero(size, size);
  AddInTiles(left, right, depth, Result<double>{g.data(), size, size, size}, Tiles::kUpper);
  // Eigen's columns are our rows: what was worked out lies below its diagonal.
  for (int64_t i = 0; i < size; ++i) {
    for (int64_t j = i + 1; j < size; ++j) g(i, j) = g(j, i);
  }
  return g;
}

void RequireEqual(int64_t a, int64_t b) {
  if (a != b) {
    throw Error("matrices with sides " + std::to_string(a) + " and " + std::to_string(b) +
                " were to be multiplied");
  }
}

}  // namespace

FunctionRows TimesTransposed(RowsView a, RowsView b) {
  RequireEqual(a.columns, b.columns);
  return Product(AsIs(a), Transposed(b), a.rows, a.columns, b.rows);
}

FunctionRows Times(RowsView a, RowsView b) {
  RequireEqual(a.columns, b.rows);
  return Product(AsIs(a), AsIs(b), a.rows, a.columns, b.columns);
}

FunctionRows TransposedTimes(RowsView a, RowsView b) {
  RequireEqual(a.rows, b.rows);
  return Product(Transposed(a), AsIs(b), a.columns, a.rows, b.columns);
}

Eigen::MatrixXd TransposedTimes(const Eigen::MatrixXd& a, RowsView b) {
  RequireEqual(a.rows(), b.rows);
  // Filled by rows, which are the columns of what Eigen holds.
  Eigen::MatrixXd transposed = Eigen::MatrixXd::Zero(b.columns, a.cols());
  AddInTiles(Factor<double>{a.data(), a.rows(), 1}, AsIs(b), b.rows,
             Result<double>{transposed.data(), a.cols(), b.columns, b.columns}, Tiles::kAll);
  return transposed.transpose();
}

Eigen::MatrixXd GramOfRows(RowsView a) { return Gram(AsIs(a), Transposed(a), a.rows, a.columns); }

Eigen::MatrixXd GramOfColumns(RowsView a) {
  return Gram(Transposed(a), AsIs(a), a.columns, a.rows);
}

std::vector<double> RowEnergies(RowsView a) {
  std::vector<double> energies(static_cast<size_t>(a.rows));
  constexpr int64_t kRows = 64;
  ParallelChunks(a.rows, kRows, [&](int64_t begin, int64_t end, int64_t) {
    for (int64_t row = begin; row < end; ++row) {
      const float* values = a.Row(row);
      double sums[4] = {};
      int column = 0;
      for (; column + 4 <= a.columns; column += 4) {
        for (int i = 0; i < 4; ++i) {
          sums[i] += double{values[column + i]} * values[column + i];
        }
      }
      for (; column < a.columns; ++column) sums[0] += double{values[column]} * values[column];
      energies[row] = (sums[0] + sums[1]) + (sums[2] + sums[3]);
    }
  });
  return energies;
}

double EnergyOf(RowsView a) {
  double energy = 0;
  for (const double row : RowEnergies(a)) energy += row;
  return energy;
}

}  // namespace lfm
