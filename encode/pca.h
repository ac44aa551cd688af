// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace lfm {

/// A real matrix F (rows x cols) that is known only by its products. `x` is (cols x width) and `y`
/// (rows x width), row-major float32; width is 8, 16 or 24. Outputs are overwritten.
struct LinearMap {
  int rows = 0, cols = 0;
  double max_abs = 0;  ///< a bound on the absolute value of the entries; prescales the products
  std::function<void(const float* x, int width, float* y)> multiply;             ///< y = F x
  std::function<void(const float* y, int width, float* x)> multiply_transposed;  ///< x = F^T y
};

struct PcaOptions {
  int terms = 3;            ///< K, 0 to 16
  double tolerance = 1e-7;  ///< stop when a pass raises the captured energy by less, relative to it
  int max_passes = 12;
};

/// Leading singular triplets: F ~ left * right^T in the first `terms` columns.
///
/// Both matrices have `width` columns, row-major. All `rank` captured directions are kept (K and
/// some more): the closed loop of the quantisation refits inside that space. Columns from `rank` on
/// are zero.
struct PcaResult {
  int terms = 0;                        ///< <= K; less where the rank is
  int rank = 0;                         ///< directions captured
  int width = 8;                        ///< stride of the two matrices
  int passes = 0;                       ///< products with F and F^T that it took
  std::vector<double> singular_values;  ///< rank; descending, > 0
  std::vector<float> left;              ///< rows x width, orthonormal columns u
  std::vector<float> right;             ///< cols x width, F^T u: orthogonal columns sigma v
};

/// Truncated PCA by randomised subspace iteration (FINDINGS 2.3; Halko, Martinsson, Tropp 2011):
/// l = max(16, K + 8) directions, capped at min(rows, cols); adaptive passes, with an
/// orthonormalisation after each product, so that singular values down to 1e-6 of the first are
/// kept apart; a Rayleigh-Ritz step of size l x l in float64. The start is a fixed pseudo-random
/// matrix: equal input gives equal output.
///
/// Residual: within 1e-6 ||F|| of the optimum where the spectrum falls off by the l-th value (rank
/// below K included, and repeated singular values); for white noise within 2e-3 ||F||. Singular
/// values below 1e-7 of the first count as zero. Zero energy, or K = 0, gives terms = 0. Entries
/// may lie anywhere in 1e+-25. Throws Error when `max_abs` or a product is not finite.
PcaResult ComputePca(const LinearMap& map, const PcaOptions& options);

/// Orthonormalises the columns of x (rows x width) in place, by two rounds of SVQB (Stathopoulos
/// and Wu 2002: eigenvectors of the column-scaled Gram matrix, float64). Columns beyond the
/// numerical rank (1e-6 of the largest after scaling) become zero. Returns the rank; the leading
/// `rank` columns are orthonormal to 1e-6.
int Orthonormalize(std::vector<float>& x, int rows, int width);

}  // namespace lfm
