// SPDX-License-Identifier: BSD-3-Clause
#include "fields/compact_rows.h"

#include <algorithm>
#include <numeric>

#include "fields/matrix_products.h"
#include "fields/matrix_terms.h"

namespace lfm {

double CompactRows::Energy() const {
  return std::accumulate(energies.begin(), energies.end(), 0.0);
}

CompactRows CompactedRows(RowsView rows, std::vector<double> energies, double lost_share,
                          int expected) {
  CompactRows result;
  result.energies = std::move(energies);
  // Any basis will do that holds enough.
  constexpr double kTolerance = 0.5;
  const MatrixTerms terms = TermsOf(
      rows, {.energy_share = 1 - lost_share, .expected_terms = expected, .tolerance = kTolerance});
  result.coordinates = terms.functions.rows > 0 ? TimesTransposed(rows, terms.functions.View())
                                                : MakeFunctionRows(rows.rows, 1);
  return result;
}

CompactRows PartOf(const CompactRows& all, const std::vector<int64_t>& which) {
  CompactRows part;
  part.coordinates = GatherRows(all.coordinates.View(), which);
  for (const int64_t row : which) part.energies.push_back(all.energies[row]);
  return part;
}

int64_t TermsNeeded(const CompactRows& rows, double share, int64_t expected) {
  const double there = EnergyOf(rows.coordinates.View());
  if (there <= 0) return 0;
  const TermsOptions options = {.energy_share = std::min(1.0, share * rows.Energy() / there),
                                .expected_terms = static_cast<int>(expected)};
  return static_cast<int64_t>(TermEnergiesOf(rows.coordinates.View(), options).energies.size());
}

int64_t TermsNeeded(RowsView full, double share, int64_t expected) {
  const TermsOptions options = {.energy_share = share,
                                .expected_terms = static_cast<int>(expected)};
  return static_cast<int64_t>(TermEnergiesOf(full, options).energies.size());
}

}  // namespace lfm
