// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include "core/options.h"
#include "core/progress.h"
#include "fields/field.h"
#include "fields/relightable_model.h"
#include "fields/sparse_clusters.h"

namespace lfm {

/// What finds clusters and their bases.
enum class FieldMethod {
  kSparseResidual,  ///< clustered sparse residual factorisation (fields/sparse_clusters.h)
  kPca,             ///< clustered PCA of a fixed number of clusters (fields/clustered_pca.h)
  kAdaptivePca,     ///< clusters divided while that pays (fields/adaptive_clusters.h)
};

struct FieldEncodeOptions {
  FieldMethod method = FieldMethod::kSparseResidual;
  /// Of clustered PCA: the numbers of clusters, terms and residuals, and the residual threshold; of
  /// adaptive PCA the last two.
  SparseClusterOptions clusters;
  double energy_share = 0.999;

  void Declare(OptionVisitor& v) {
    v.Enumeration({"field-method",
                   "How captures that vary in light are factorised: csrf, clusters of least "
                   "absolute error (Yamada 2009), cpca, clustered PCA (Sloan 2003), or "
                   "adaptive-cpca, clusters divided while the cost of relighting falls (Mahajan "
                   "2007)."},
                  {"csrf", "cpca", "adaptive-cpca"}, method);
    clusters.Declare(v);
    v.Number(
        {"energy-share",
         "Of adaptive-cpca: what a cluster's terms hold of its energy; more terms, less error.", "",
         0, 1},
        energy_share);
  }
};

struct FieldEncodeResult {
  RelightableModel model;  ///< numbers as a .lfr file holds them
  nlohmann::json figures;  ///< for the report: docs/formats.md, encode.json of such captures
};

/// The field as a clustered model to be relit. Clustered PCA keeps a residual by the same rule
/// (fields/residual.h), so that both are compared at equal bytes. Throws Error as ClusterSparse and
/// ClusterRows do.
FieldEncodeResult EncodeField(const Field& field, const FieldEncodeOptions& options,
                              Progress& progress);

/// The same model with at most so many residual entries a row, the largest; negative: as it is.
RelightableModel WithFewerResiduals(RelightableModel relightable, int residuals);

}  // namespace lfm
