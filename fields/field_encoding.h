// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include "core/options.h"
#include "core/progress.h"
#include "fields/cpca.h"
#include "fields/field.h"
#include "fields/relightable_model.h"
#include "fields/sparse_clusters.h"

namespace lfm {

/// What finds clusters and their bases.
enum class FieldMethod {
  kSparseResidual,  ///< clustered sparse residual factorisation (fields/sparse_clusters.h)
  kPca,             ///< clustered PCA (fields/cpca.h)
};

struct FieldEncodeOptions {
  FieldMethod method = FieldMethod::kSparseResidual;
  SparseClusterOptions sparse;  ///< `residuals` and `residual_threshold` hold for both methods
  CpcaOptions pca;

  void Declare(OptionVisitor& v) {
    v.Enumeration({"field-method",
                   "How captures that vary in light are factorised: csrf, clusters of least "
                   "absolute error (Yamada 2009), or cpca, clustered PCA (Sloan 2003, Mahajan "
                   "2007)."},
                  {"csrf", "cpca"}, method);
    sparse.Declare(v);
    pca.Declare(v);
  }
};

struct FieldEncodeResult {
  RelightableModel model;  ///< numbers as a .lfr file holds them
  nlohmann::json figures;  ///< for the report: docs/formats.md, encode.json of such captures
};

/// The field as a clustered model to be relit. Clustered PCA keeps a residual by the same rule
/// (fields/residual.h), so that both are compared at equal bytes. Throws Error as ClusterSparse
/// and EncodeClusteredPca do.
FieldEncodeResult EncodeField(const Field& field, const FieldEncodeOptions& options,
                              Progress& progress);

/// The same model with at most so many residual entries a row, the largest; negative: as it is.
RelightableModel WithFewerResiduals(RelightableModel relightable, int residuals);

}  // namespace lfm
