// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "fields/function_rows.h"
#include "fields/l1_solver.h"

namespace lfm {

/// A basis as the float64 solvers want it: independent orthogonal functions of unit mean square.
struct Float64Basis {
  Eigen::MatrixXd functions;   ///< r x m
  Eigen::MatrixXd from_basis;  ///< r x t: shared weights = from_basis * weights
  Eigen::MatrixXd to_basis;    ///< t x r: weights = to_basis * shared weights
};

Float64Basis ShareInFloat64(RowsView basis);

/// A row b as target * 2^exponent, of a mean magnitude of about 1 (or zeros).
struct Float64Row {
  Eigen::VectorXd target;
  int exponent = 0;
};

Float64Row ScaledRow(const float* row, int columns);

/// Weights of the basis (t numbers) as weights of the shared functions for the scaled row, and
/// back.
Eigen::VectorXd ToShared(const Float64Basis& shared, const Float64Row& row, const float* weights);
Eigen::VectorXd FromShared(const Float64Basis& shared, const Float64Row& row,
                           const Eigen::VectorXd& weights);

/// SolveL1 by the float64 solvers, row by row: kExact, kLinearProgramme, kQuadraticProgramme, and
/// whatever asks for a positive residual.
L1Solution SolveInFloat64(RowsView basis, RowsView targets, const L1Options& options,
                          const std::vector<float>& start);

}  // namespace lfm
