// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "fields/clustered_model.h"
#include "fields/function_rows.h"

namespace lfm {

/// N functions for the whole scene and each cluster's basis as combinations of them (Mahajan 2007,
/// Section 4.1, after Nayar 2004): light is projected into N numbers once, not into l directions
/// for every cluster, so that a frame costs sum n_i (N + p_i), Equation 18.
struct GlobalBasis {
  FunctionRows functions;           ///< N x columns, orthonormal
  std::vector<FunctionRows> local;  ///< a cluster: terms x N; no rows where it has no terms
};

struct GlobalBasisOptions {
  double energy_share = 0.999;
  int max_terms = 4096;
};

/// From the second SVD, of all bases stacked, each function by the length of its weights: what is
/// left out costs as little squared error over all rows as N functions can.
GlobalBasis GlobalBasisOfModel(const ClusteredModel& model, const GlobalBasisOptions& options);
/// From a subset of the rows themselves (the paper's alternative).
GlobalBasis GlobalBasisOfRows(const ClusteredModel& model, RowsView subset,
                              const GlobalBasisOptions& options);

/// The model with its bases as the global ones give them, to measure what that adds to the error.
ClusteredModel ThroughGlobalBasis(const ClusteredModel& model, const GlobalBasis& global);

/// Every row times light (`light`: columns numbers; residuals take no part), Equation 17: bases
/// times light, then weights times what came out.
std::vector<float> Relit(const ClusteredModel& model, const std::vector<float>& light);
/// The same by Equation 18.
std::vector<float> Relit(const ClusteredModel& model, const GlobalBasis& global,
                         const std::vector<float>& light);

}  // namespace lfm
