// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "encode/factored_operator.h"
#include "encode/map_quantization.h"
#include "encode/pca_solver.h"
#include "encode/shared_samples.h"

namespace lfm {

/// The quantised factors of one vertex and how well they do.
struct VertexTerms {
  std::vector<TermMaps> terms;  ///< as many as are visible, at most the wanted number
  /// ||F - U V^T||^2 of the first 0, 1, ... quantised terms, all directions alike: one more than
  /// terms; the first is ||F||^2, mean view removed.
  std::vector<double> squared_errors;
  int64_t entries = 0;  ///< rows of triangles that photographs saw, times 3N
  /// Share of the (direction-weighted) energy that each wanted term captures before quantisation;
  /// 0 where there is no energy.
  std::vector<double> singular_value_share;
};

struct FactorizationOptions {
  int terms = 3;  ///< K, 0 to 16
  PcaSolver solver = PcaSolver::kFactored;
  Precision precision = Precision::kSingle;  ///< of the factored solver
  double guessed_weight = 0.2;  ///< of directions outside the hull of the photographs, in (0, 1]
};

/// Factorises one vertex light field and quantises it in closed loop (Chen 2002, Appendix): the
/// surface map of term p + 1 is the leading left singular vector of what the *quantised* first p
/// terms left over, inside the subspace that the solver captured and that was made continuous over
/// the ring's edges; it is split by SplitAlpha and quantised; then its view map is the exact least
/// squares fit of that remainder to the quantised surface map, and is quantised too. The first
/// terms do not depend on whether others follow (fitting all view maps once more, together, gave
/// 0.0004 dB). `shared` lists the shared samples of the ring (patches in the order of the blocks).
///
/// In triangles that nobody saw the maps go on as the rest of the ring does on average; they do not
/// enter the fit or the figures.
///
/// A column (direction) counts with guessed_weight + (1 - guessed_weight) * (share of the ring's
/// samples whose triangle has it inside the hull of its photographs). Terms end when the largest
/// value that the next could add is below half an 8-bit level. No energy: no terms.
VertexTerms FactorizeVertex(const VertexOperator& f, const SharedSamples& shared,
                            const FactorizationOptions& options);

/// Square roots of the column weights, N entries.
std::vector<float> ColumnScale(const VertexOperator& f, double guessed_weight);

}  // namespace lfm
