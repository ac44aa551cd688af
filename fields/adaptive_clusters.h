// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "fields/clustered_pca.h"
#include "fields/cost_model.h"
#include "fields/function_rows.h"

namespace lfm {

struct AdaptiveOptions {
  int initial_clusters = 8;     ///< of the first clustered PCA; the paper takes 5 to 10
  double energy_share = 0.999;  ///< of every cluster's energy that its terms hold: n
  double global_terms = 0;      ///< N of the cost; see GlobalTerms
  int64_t full_rows = 2000;     ///< up to this many rows a cluster is divided by its full rows
  int search_terms = 8;         ///< t of the first clustered PCA
  int iterations = 16;          ///< of every clustered PCA
  int64_t min_rows = 1;         ///< no cluster of less
};

/// A cluster that was there at some step of the division.
struct DivisionNode {
  int parent = -1;  ///< -1: one of the first
  int children[2] = {-1, -1};
  int cluster = -1;  ///< number of what was not divided
  PatchSize size = {};
  double gain = 0;  ///< d of the best division found (Equation 22); > 0: divided
};

struct AdaptiveClusters {
  Clustering clustering;
  std::vector<DivisionNode> nodes;  ///< parents before children
  RenderingCost cost;               ///< of the clusters, measured
};

/// Mahajan 2007, Section 5.2: a clustered PCA with few clusters, then each is divided in two by
/// clustered PCA as long as the measured cost falls, d = n (p + N) - sum n_j (p_j + N) > 0. n is
/// what holds `energy_share` of the full rows' energy. `reduced` are the same rows in few
/// coordinates (fields/wavelet_reduction.h): the first clusters and the division of clusters of
/// more than `full_rows` rows look at these; the others look at the full rows in their own leading
/// singular vectors, which at every level of division lose at most 1/1024 of what the share leaves
/// out. A division is tried with three numbers of basis functions a half (an eighth, a quarter and
/// a half of n), the cheapest counts.
///
/// One row, equal rows and black rows are not divided; without rows there are no clusters. The
/// result does not depend on the number of threads. Throws Error when an option is out of range,
/// `reduced` has another number of rows, or a number is not finite.
AdaptiveClusters DivideClusters(RowsView full, RowsView reduced, const AdaptiveOptions& options);

/// N: how many terms hold `share` (the paper: 99.9 %) of the energy of `sample` rows, evenly drawn
/// from all that are not black (Mahajan 2007, Section 5.1). At least 1.
int64_t GlobalTerms(RowsView rows, int64_t sample, double share);

}  // namespace lfm
