// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "encode/pca.h"

namespace lfm {

struct NmfOptions {
  int terms = 3;  ///< K, 0 to 16
  /// Iterations end when one lowers the squared error by less than this share of it (of what lies
  /// in the captured subspace, and 1e-8 ||F||^2).
  double tolerance = 2e-3;
  int max_iterations = 200;  ///< on the captured subspace
  int max_exact = 10;        ///< afterwards, on F itself
};

/// F ~ left * right^T, all entries nonnegative (Chen 2002, Appendix): not progressive, other than
/// PCA. Both matrices have `width` columns, row-major; those from `terms` on are zero. Columns of
/// `left` sum to one, and are in the order of the energy of their term.
struct NmfResult {
  int terms = 0;  ///< <= K; terms that came out as zero are dropped
  int width = 8;
  int iterations = 0, exact_iterations = 0;
  std::vector<float> left;        ///< rows x width
  std::vector<float> right;       ///< cols x width
  double squared_error_fall = 0;  ///< ||F||^2 - ||F - left right^T||^2
};

/// Nonnegative factorisation by hierarchical alternating least squares (Cichocki, Zdunek, Amari
/// 2007): each row of one factor descends to its nonnegative least squares fit to the other, entry
/// by entry (accelerated as Gillis and Glineur 2012: several rounds a product with F).
///
/// Starts from the K leading singular triplets split into their nonnegative parts (NNDSVD,
/// Boutsidis and Gallopoulos 2008). Most iterations run inside the subspace that ComputePca
/// captures, where products with F cost (rows + cols) l K instead of all of F; the last ones run on
/// F itself, so the result is a fit to F. The error never rises from one to the next of those.
///
/// Entries of F that are negative (rounding, a subtracted mean) are data like others; the factors
/// stay nonnegative. No energy, or K = 0, gives terms = 0. Throws Error when `max_abs` or a product
/// is not finite.
NmfResult ComputeNmf(const LinearMap& map, const NmfOptions& options);

/// Nonnegative least squares by coordinate descent: each row x (`terms` numbers) goes towards the
/// minimum of x G x^T - 2 x p^T over x >= 0 from where it is, `rounds` times through its entries.
/// `products` and `x` have equal sizes. `terms` is at most 16. Entries whose diagonal of G is not
/// positive stay as they are.
void DescendNonnegative(const std::vector<float>& products, const Eigen::MatrixXd& gram, int terms,
                        int rounds, std::vector<float>& x);

}  // namespace lfm
