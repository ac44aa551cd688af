// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "encode/factored_operator.h"
#include "encode/pca.h"

namespace lfm {

/// A real matrix F (rows x cols) known by its products in float64.
struct PreciseMap {
  int rows = 0, cols = 0;
  std::function<Eigen::MatrixXd(const Eigen::MatrixXd& x)> multiply;             ///< F x
  std::function<Eigen::MatrixXd(const Eigen::MatrixXd& y)> multiply_transposed;  ///< F^T y
};

/// F diag(column_scale) of a vertex ring, as ScaledMap, its float32 factors multiplied in float64.
/// Both arguments must outlive the result.
PreciseMap PreciseScaledMap(const VertexOperator& f, const std::vector<float>& column_scale);

/// Leading singular triplets in float64: F ~ left * right^T in the first `terms` columns.
struct PrecisePca {
  int terms = 0;                    ///< <= K; less where the rank is
  int passes = 0;                   ///< products with F and F^T that it took
  Eigen::VectorXd singular_values;  ///< of all captured directions, descending, > 0
  Eigen::MatrixXd left;             ///< rows x captured, orthonormal columns u
  Eigen::MatrixXd right;            ///< cols x captured, F^T u
};

/// ComputePca in float64 throughout: max(16, K + 8) directions (at most min(rows, cols)), passes
/// until one raises the captured energy by less than 1e-14 of it, 200 at most. ||F - F_K|| then is
/// within 1e-10 ||F|| of the optimum where the spectrum falls off by the last direction by a tenth
/// or more; where it is flat, within 1e-3 ||F||. Singular values below 1e-14 of the first count as
/// zero. Zero energy, or K = 0, gives terms = 0. Entries may lie anywhere in 1e+-100. Throws Error
/// when a product is not finite, or K is not in [0, 16]. About 20 times the time of ComputePca.
PrecisePca ComputePrecisePca(const PreciseMap& map, int terms);

/// Rounded to what ComputePca returns.
PcaResult RoundedToFloat(const PrecisePca& pca, int rows, int cols);

}  // namespace lfm
