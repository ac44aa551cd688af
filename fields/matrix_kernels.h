// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

/// Dense products, compiled for several instruction sets and dispatched at run time. Plain pointers
/// only: no Eigen object may cross, since its alignment depends on the instruction set. Most
/// callers want fields/matrix_products.h instead.
namespace lfm::kernels {

/// A matrix in place: element (r, c) is values[r * row_step + c * column_step].
template <typename Number>
struct Factor {
  const Number* values;
  int64_t row_step, column_step;
};

/// The largest tile of a product that one call works out, and the numbers that it needs to work in.
inline constexpr int kProductTile = 256;
inline constexpr int kProductWorkspace = 2 * 128 * (kProductTile + 64);

/// c += a b, a being rows x depth and b depth x columns, both of at most kProductTile rows and
/// columns; c is row-major, `c_step` apart. `workspace` holds kProductWorkspace numbers.
/// Results are the same from run to run on one instruction set and differ in the last bits between
/// instruction sets.
void AddProduct(Factor<float> a, Factor<float> b, int rows, int64_t depth, int columns, float* c,
                int64_t c_step, float* workspace);
/// The same in float64: products of float32 are exact, sums are rounded in float64.
void AddProduct(Factor<float> a, Factor<float> b, int rows, int64_t depth, int columns, double* c,
                int64_t c_step, double* workspace);
void AddProduct(Factor<double> a, Factor<float> b, int rows, int64_t depth, int columns, double* c,
                int64_t c_step, double* workspace);

}  // namespace lfm::kernels
