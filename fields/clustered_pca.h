// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "fields/clustered_model.h"
#include "fields/cost_model.h"
#include "fields/function_rows.h"
#include "fields/matrix_terms.h"

namespace lfm {

/// Which cluster every row belongs to; every cluster has a row.
struct Clustering {
  int clusters = 0;
  std::vector<int> cluster;  ///< a row

  /// The rows of every cluster, rising.
  std::vector<std::vector<int64_t>> Members() const;
};

struct ClusterSearchOptions {
  int clusters = 64;  ///< k; fewer come out where rows do not differ or clusters are too small
  int terms = 8;      ///< t, basis functions of a cluster while rows look for theirs
  int iterations = 16;
  double tolerance = 1e-3;  ///< stop when the error falls by less, relative to it
  int64_t min_rows = 1;     ///< smaller clusters are dissolved at the end
};

/// Clustered PCA (Sloan 2003, Section 4.2): assigns each row to the cluster whose t basis functions
/// leave the least squared error, then finds each cluster's best functions anew, in turns; the
/// error never rises. Functions are not centred (Mahajan 2007, footnote 2). Begins with lines
/// through rows, each drawn by what the lines before it leave of the rows; a cluster that loses all
/// rows begins again at the row that is approximated worst. No randomness but a fixed sequence, and
/// the same result for any number of threads.
///
/// `rows` may be reduced (fields/wavelet_reduction.h) as long as distances are about kept. Rows of
/// zeros go anywhere. Without rows there are no clusters. Throws Error when an option is out of
/// range or a number is not finite.
Clustering ClusterRows(RowsView rows, const ClusterSearchOptions& options);

/// Bases and weights of given clusters, always from full rows: as few terms as `terms` asks for
/// in every cluster (energy_share: that much of each cluster's own energy). Without residual.
/// Throws Error beyond 65536 clusters.
ClusteredModel ModelOfClusters(RowsView rows, const Clustering& clustering,
                               const TermsOptions& terms);

/// How many rows and how many terms every cluster of a model has.
std::vector<PatchSize> SizesOf(const ClusteredModel& model);
/// The same as SizesOf(ModelOfClusters(...)), without working out bases and weights.
std::vector<PatchSize> MeasureClusters(RowsView rows, const Clustering& clustering,
                                       const TermsOptions& terms);

}  // namespace lfm
