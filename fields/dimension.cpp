// SPDX-License-Identifier: BSD-3-Clause
#include "fields/dimension.h"

#include <algorithm>
#include <string>

#include "core/error.h"
#include "fields/matrix_terms.h"

namespace lfm {
namespace {

void RequireShare(double share) {
  if (!(share >= 0 && share <= 1)) {
    throw Error("a share of the energy must lie between 0 and 1, not " + std::to_string(share));
  }
}

}  // namespace

int DimensionOf(RowsView rows, double share, int expected) {
  RequireShare(share);
  TermsOptions options;
  options.energy_share = share;
  options.expected_terms = expected;
  const MatrixTerms terms = TermEnergiesOf(rows, options);
  return TermsHolding(terms.energies, terms.energy, share);
}

int DimensionOf(const std::vector<double>& eigenvalues, double share) {
  RequireShare(share);
  double total = 0;
  for (const double value : eigenvalues) total += std::max(value, 0.0);
  return TermsHolding(eigenvalues, total, share);
}

}  // namespace lfm
