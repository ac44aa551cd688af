// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fields/clustered_model.h"

namespace lfm {

/// How much of the residual is kept (Yamada 2009, Section 3.4).
struct ResidualOptions {
  int largest = -1;              ///< n: so many a row at most; -1: all above the threshold
  double threshold = 1.0 / 256;  ///< only magnitudes above this, in units of the rows
};

/// The model with the residual E = R - W F in place of any that it had: of each row the entries
/// above the threshold, of those the n largest by magnitude, ties by column, largest first.
///
/// Values are rounded to stored numbers (fields/stored_numbers.h) before they are chosen, and E is
/// taken against the weights and bases as they stand: round those first (RoundToStored), and the
/// loop is closed; with threshold 0 and no n the model then gives each row back to float16's
/// 2^-11 of E. Without columns left (n = 0) every row has an empty residual.
/// Parallel over rows. Throws Error when `truth` is of another size, n < -1, the threshold is
/// negative or not finite, or there are more than 65536 columns.
ClusteredModel WithResidual(ClusteredModel model, RowsView truth, const ResidualOptions& options);

/// The share of all entries of E = R - W F that are at most `threshold`, over the rows `which`
/// (empty: all) that have energy; 1 without any (Yamada 2009, Figure 4 (d)).
double ResidualSparseness(const ClusteredModel& model, RowsView truth, double threshold,
                          const std::vector<int64_t>& which = {});

}  // namespace lfm
