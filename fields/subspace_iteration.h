// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fields/function_rows.h"

namespace lfm {

/// What a subspace iteration has to find.
struct SubspaceTarget {
  int terms = 0;            ///< no more are of interest
  double energy = 0;        ///< of the whole matrix
  double share = 1;         ///< of the energy: fewer terms do when they hold it
  int expected_terms = 0;   ///< where to start; 0: unknown
  int most_terms = 0;       ///< give up beyond: the subspace is not worth it
  double tolerance = 1e-3;  ///< iterate until the energy caught grows by less of what is missing
};

/// Ritz pairs of A A^T on an orthonormal basis of columns.
struct Subspace {
  std::vector<double> energies;  ///< Ritz values, largest first
  FunctionRows projected;        ///< Q^T A
  Eigen::MatrixXd rotation;      ///< its rows' combinations that belong to `energies`, columns
  bool holds_share = false;      ///< enough: `terms` of them or the share
};

/// Randomised subspace iteration (Halko, Martinsson and Tropp 2011, Algorithm 4.4, with Cholesky QR
/// in between). The subspace is doubled until it holds the share, with an eighth more than what
/// counts. `a` must be finite and have energy.
Subspace IterateSubspace(RowsView a, const SubspaceTarget& target);

}  // namespace lfm
