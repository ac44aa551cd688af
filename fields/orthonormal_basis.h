// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "fields/function_rows.h"

namespace lfm {

/// F = L Q (up to what is dependent), float64.
struct OrthonormalBasis {
  Eigen::MatrixXd functions;  ///< Q: rank x m, orthonormal
  Eigen::MatrixXd mixing;     ///< L: t x rank
  /// rank x t: weights of F from weights of Q, x = y `inverse`. Functions that depend on the others
  /// get none.
  Eigen::MatrixXd inverse;

  int Rank() const { return static_cast<int>(functions.rows()); }
};

/// By modified Gram-Schmidt with the largest remaining function first, twice. A function of which
/// less than 1e-5 remains is dependent: zero, repeated, or a sum of others. Magnitudes may lie
/// anywhere in float32's range.
OrthonormalBasis Orthonormalize(RowsView basis);

}  // namespace lfm
