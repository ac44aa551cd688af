// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "fields/row_clusters.h"

// Neither too many rows in a cluster nor too few (Yamada 2009, Section 5). Private to fields.

namespace lfm {

struct ClusterSizeLimits {
  int64_t smallest = 1;                ///< rows
  int64_t largest = INT64_C(1) << 62;  ///< rows; at least twice the smallest
  int most_clusters = 65534;
};

/// Bases and who is in them.
struct ClusterState {
  std::vector<FunctionRows> bases;  ///< no rows: nobody is in it
  RowClusters rows;
};

/// Dissolves clusters below the limit, the smallest first: each member goes to its next best
/// cluster, with its weights and error there. One cluster stays whatever its size.
ClusterState MergeSmallClusters(const ActiveRows& rows, ClusterState state,
                                const ClusterSizeLimits& limits, const L1Options& l1);

/// Halves clusters above the limit, the largest first, each half with a basis of its own: at the
/// median along the direction in which the members' weights, scaled to unit norm, vary most. A half
/// takes the number of a cluster without members, else a new one; when there is none left, the
/// limit gives way.
ClusterState SplitLargeClusters(const ActiveRows& rows, ClusterState state,
                                const ClusterSizeLimits& limits,
                                const SparseFactorizationOptions& options);

/// Halves the clusters with the greatest error until `wanted` have members, or no cluster has
/// twice the smallest size.
ClusterState SplitWorstClusters(const ActiveRows& rows, ClusterState state, int wanted,
                                const ClusterSizeLimits& limits,
                                const SparseFactorizationOptions& options);

}  // namespace lfm
