// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <vector>

#include "fields/function_rows.h"

namespace lfm {

/// Whether the mean row is taken off first. Mahajan 2007 does not (Section 2, footnote 2).
enum class Centring { kNone, kMean };

/// How singular values are found.
enum class TermsMethod {
  kAutomatic,  ///< kExact where the smaller side is short or most terms are asked for
  kExact,      ///< all eigenvalues of the float64 Gram matrix of the smaller side
  kSubspace,  ///< randomised subspace iteration in float32, a float64 Rayleigh-Ritz step at its end
};

struct TermsOptions {
  int max_terms = std::numeric_limits<int>::max();
  double energy_share = 1;  ///< no more terms than hold this share of the energy, 0 to 1
  Centring centring = Centring::kNone;
  TermsMethod method = TermsMethod::kAutomatic;
  int expected_terms = 0;   ///< where kSubspace starts; changes the time, not what is asked for
  double tolerance = 1e-3;  ///< of kSubspace
};

/// The leading singular vectors of a matrix A (Mahajan 2007, Equation 2: T = U S V^T).
struct MatrixTerms {
  double energy = 0;             ///< sum of squares of A, all terms together (centred, if asked)
  std::vector<double> energies;  ///< squared singular values, largest first, one a term
  FunctionRows functions;        ///< V^T, terms x columns, orthonormal; no rows: no terms
  std::vector<float> mean;       ///< the mean row; empty for Centring::kNone

  /// What the terms hold together, from the Rayleigh-Ritz step: the check of kSubspace.
  double CapturedEnergy() const;
};

/// The first terms of `a`: as few as hold `energy_share`, at most `max_terms`. Terms whose singular
/// value is below 1e-6 of the first (float32 rounding) are left out, so repeated rows, constant
/// matrices and ranks below what is asked for give fewer terms, and a matrix without rows or with
/// nothing but zeros none. kSubspace iterates until the energy caught grows by less than
/// `tolerance` of what is missing; where it cannot hold the share with a third of the smaller side,
/// kAutomatic goes on to kExact. Magnitudes may lie anywhere in 1e+-25. Deterministic. Throws Error
/// when a number is not finite or an option is out of range.
MatrixTerms TermsOf(RowsView a, const TermsOptions& options);

/// The same without the functions: a third of the time of kExact.
MatrixTerms TermEnergiesOf(RowsView a, const TermsOptions& options);

/// All min(rows, columns) squared singular values, largest first, never negative: exact.
std::vector<double> EnergySpectrum(RowsView a, Centring centring = Centring::kNone);

/// The dimensionality of Mahajan 2007, Section 3: how many of `energies` (largest first) hold
/// `share` of `total`. All of them when they do not; 0 when there is no energy.
int TermsHolding(const std::vector<double>& energies, double total, double share);

/// Coefficients of rows in orthonormal functions, rows x terms, row-major without padding.
std::vector<float> CoefficientsOf(RowsView rows, RowsView functions);

}  // namespace lfm
