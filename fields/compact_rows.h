// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "fields/function_rows.h"

namespace lfm {

/// Rows in the coordinates of their own leading singular vectors: their dimensionality, and that of
/// any part of them, can be measured without the directions.
struct CompactRows {
  FunctionRows coordinates;      ///< rows x as many as they need; 1 column of zeros without energy
  std::vector<double> energies;  ///< squared lengths of the full rows

  double Energy() const;
};

/// All but `lost_share` of the energy of `rows`, whose full squared lengths are `energies` (rows
/// may be coordinates already; what was lost before adds up). `expected` is how many coordinates
/// are tried first.
CompactRows CompactedRows(RowsView rows, std::vector<double> energies, double lost_share,
                          int expected = 0);

/// Some of them, in the same coordinates.
CompactRows PartOf(const CompactRows& all, const std::vector<int64_t>& which);

/// How many terms hold `share` of the energy of the full rows. `expected` is where to look first.
int64_t TermsNeeded(const CompactRows& rows, double share, int64_t expected = 0);
int64_t TermsNeeded(RowsView full, double share, int64_t expected = 0);

}  // namespace lfm
