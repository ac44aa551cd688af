// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace lfm {

/// The two algorithms of Chen 2002's appendix as they are printed, on a matrix F (M x N) that is
/// formed: what the factored solvers are measured against, and `--solver paper`.

struct PaperOptions {
  int terms = 3;            ///< K; columns beyond the rank are left out
  double tolerance = 1e-6;  ///< of convergence, see below
  /// Repeated singular values never converge by the test on v (no one vector is theirs), and
  /// multiplicative updates slow down for ever.
  int max_iterations = 10000;
};

/// F ~ left * right^T. For PCA: unit u times alpha-split lambda on both sides; columns in the order
/// of lambda. For NMF: nonnegative, columns of `left` sum to one.
template <typename Scalar>
struct PaperFactors {
  Eigen::MatrixX<Scalar> left, right;   ///< M x terms, N x terms
  std::vector<double> singular_values;  ///< PCA: lambda
  std::vector<int> iterations;          ///< PCA: of each term; NMF: one number
};

/// PCA: for each term the Gram matrix of what the terms before left over, and power iteration on it
/// from a pseudo-random vector until the unit vector v moves by less than `tolerance`. The printed
/// `lambda <- sqrt(A v)` is read as sqrt(||A v||). A remainder whose entries are all below
/// 1e-6 (float) or 1e-12 (double) of the largest of F ends it. float and double are instantiated.
/// Throws Error when F is not finite.
template <typename Scalar>
PaperFactors<Scalar> PaperPca(const Eigen::MatrixX<Scalar>& f, const PaperOptions& options);

/// NMF: Lee and Seung's multiplicative updates with the appendix's normalisation, from a
/// pseudo-random positive start, until the squared error falls by less than `tolerance` of itself
/// over ten iterations. As printed both factors are updated from the same old pair, which may raise
/// the error and never settle: here V follows the new U, as Lee and Seung prove convergence for.
/// Needs nonnegative F; throws Error for negative or non-finite entries. Entries whose denominator
/// is zero become zero. A zero matrix has no terms.
template <typename Scalar>
PaperFactors<Scalar> PaperNmf(const Eigen::MatrixX<Scalar>& f, const PaperOptions& options);

}  // namespace lfm
