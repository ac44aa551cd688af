// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "fields/function_rows.h"

namespace lfm {

/// How the columns lie: `faces` pictures one after the other, each row by row. A cube map has six
/// of N x N; a list of directions without a grid is one picture of one line.
struct ColumnGrid {
  int faces = 1, height = 1, width = 1;
  int columns() const { return faces * height * width; }
};

/// The grid of a cube map with this many columns when there is one; else one line of them.
ColumnGrid GridOfColumns(int columns);

/// The orthonormal Haar transform of one row in place: across and down in turns (the non-standard
/// form), to one coefficient a face. Where a side is odd, its last sample waits for the next level.
void TransformHaar(const ColumnGrid& grid, float* row);
/// Its inverse.
void InvertHaar(const ColumnGrid& grid, float* row);

/// Rows in few wavelet coefficients.
struct WaveletReduction {
  std::vector<int> kept;  ///< coefficients' numbers, rising
  FunctionRows rows;      ///< rows x kept
  double kept_share = 1;  ///< of the energy; 1 without energy
};

/// The `coefficients` that hold most energy over all rows together (Mahajan 2007, Section 5.2;
/// after Ng 2003), at most as many as there are. Distances between rows of the result are those of
/// the full rows up to what was left out. Throws Error when the grid does not fit, nothing is to
/// be kept, or a number is not finite.
WaveletReduction ReduceByWavelets(RowsView rows, const ColumnGrid& grid, int coefficients);

}  // namespace lfm
