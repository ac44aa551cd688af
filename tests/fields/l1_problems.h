// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "fields/function_rows.h"
#include "fields/l1_solver.h"

namespace lfm {

/// A matrix W F + E as Yamada 2009, Section 3.2 tests with: W and F uniform in [0, 1), E zero but
/// for a part `spikes` of its entries, uniform in [-1, 1).
struct SpikedLowRank {
  FunctionRows matrix, basis;
  double spike_error = 0;  ///< sum |E|
};
SpikedLowRank MakeSpikedLowRank(int rows, int columns, int terms, double spikes, uint32_t seed);

/// Rows like reflectance functions: a diffuse and a specular lobe about normals of a hemisphere,
/// half of the lights of some shadowed, noise of a thousandth.
FunctionRows MakeReflectanceLike(int rows, int columns, uint32_t seed);

/// Numbers uniform in [-1, 1).
FunctionRows MakeNoise(int rows, int columns, uint32_t seed);

Eigen::MatrixXd ToDense(RowsView matrix);

/// The least error of one row among all weights that meet as many columns as there are functions
/// (one of them is optimal), found by trying all: for tiny problems whose functions are
/// independent. Infinite when none leaves a residual of the sign.
double LeastErrorByTrying(RowsView basis, const float* target, ResidualSign sign);

}  // namespace lfm
