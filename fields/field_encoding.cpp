// SPDX-License-Identifier: BSD-3-Clause
#include "fields/field_encoding.h"

#include <algorithm>
#include <utility>

#include "fields/relightable_file.h"
#include "fields/residual.h"
#include "fields/stored_numbers.h"

namespace lfm {
namespace {

using nlohmann::json;

// The basis's functions as what a model's columns are: column j of psi for every direction.
ColumnBasis ToColumnBasis(const HaarBasis& haar) {
  FunctionRows identity = MakeFunctionRows(haar.columns, haar.columns);
  for (int i = 0; i < haar.columns; ++i) identity.Row(i)[i] = 1;
  const FunctionRows psi = ToHaar(haar, std::move(identity));
  ColumnBasis basis;
  for (int j = 0; j < haar.columns; ++j) {
    basis.first.push_back(static_cast<int64_t>(basis.value.size()));
    for (int i = 0; i < haar.columns; ++i) {
      if (psi.Row(i)[j] == 0) continue;
      basis.direction.push_back(static_cast<uint32_t>(i));
      basis.value.push_back(psi.Row(i)[j]);
    }
  }
  basis.first.push_back(static_cast<int64_t>(basis.value.size()));
  return basis;
}

void EncodeSparse(const Field& field, const SparseClusterOptions& options, Progress& progress,
                  FieldEncodeResult& result) {
  SparseClusterResult clusters = ClusterSparse(field, options, progress);
  if (clusters.haar) result.model.column_basis = ToColumnBasis(*clusters.haar);
  result.model.model = std::move(clusters.model);
  result.figures["clusters"] = clusters.clusters;
  result.figures["smallest_cluster"] = clusters.smallest_cluster;
  result.figures["largest_cluster"] = clusters.largest_cluster;
  result.figures["bootstrap_factor"] = clusters.bootstrap_factor;
  result.figures["dark_rows"] = clusters.dark_rows;
  result.figures["bootstrap_error"] = clusters.bootstrap_error;
  result.figures["full_error"] = clusters.full_error;
}

void EncodePca(const Field& field, const FieldEncodeOptions& options, Progress& progress,
               FieldEncodeResult& result) {
  progress.Start("encode: clustered PCA", 2);
  CpcaResult clusters = EncodeClusteredPca(field, options.pca);
  progress.Advance();
  result.model.model =
      WithResidual(RoundToStored(std::move(clusters.model)), field.functions.View(),
                   {options.sparse.residuals, options.sparse.residual_threshold});
  progress.Advance();
  result.figures["clusters"] = clusters.sizes.size();
  result.figures["global_terms"] = clusters.global_terms;
  result.figures["cost_per_pixel"] = clusters.cost.PerPixel();
}

}  // namespace

FieldEncodeResult EncodeField(const Field& field, const FieldEncodeOptions& options,
                              Progress& progress) {
  FieldEncodeResult result;
  result.model = MakeRelightable(field);
  result.figures = {{"method", options.method == FieldMethod::kPca ? "cpca" : "csrf"},
                    {"points", field.points},
                    {"channels", field.channels},
                    {"directions", field.functions.columns}};
  if (options.method == FieldMethod::kPca) {
    EncodePca(field, options, progress, result);
  } else {
    EncodeSparse(field, options.sparse, progress, result);
  }
  const ClusteredModel& model = result.model.model;
  const RelightableBytes bytes = CountBytes(result.model);
  const auto rows = static_cast<double>(std::max<int64_t>(1, model.rows));
  const double raw = rows * field.functions.columns;
  result.figures["residuals_per_row"] = static_cast<double>(model.residual_value.size()) / rows;
  result.figures["residual_share"] = static_cast<double>(model.residual_value.size()) / raw;
  result.figures["model_bytes"] = bytes.Total();
  result.figures["basis_bytes"] = bytes.bases;
  result.figures["weight_bytes"] = bytes.weights + bytes.clusters;
  result.figures["residual_bytes"] = bytes.residual_indices + bytes.residual_values;
  // Against pictures of a byte a value.
  result.figures["compression_ratio"] = raw / static_cast<double>(bytes.Total());
  if (result.model.column_basis.IsIdentity()) {
    result.figures["relative_error"] = RelativeError(model, field.functions.View(), -1);
    result.figures["relative_error_without_residual"] =
        RelativeError(model, field.functions.View(), 0);
  }
  return result;
}

RelightableModel WithFewerResiduals(RelightableModel relightable, int residuals) {
  ClusteredModel& model = relightable.model;
  if (residuals < 0 || model.first_residual.empty()) return relightable;
  int64_t kept = 0;
  for (int64_t row = 0; row < model.rows; ++row) {
    const int64_t begin = model.first_residual[row];
    const int64_t end = std::min(model.first_residual[row + 1], begin + residuals);
    model.first_residual[row] = kept;
    for (int64_t i = begin; i < end; ++i, ++kept) {
      model.residual_column[kept] = model.residual_column[i];
      model.residual_value[kept] = model.residual_value[i];
    }
  }
  model.first_residual[model.rows] = kept;
  model.residual_column.resize(static_cast<size_t>(kept));
  model.residual_value.resize(static_cast<size_t>(kept));
  return relightable;
}

}  // namespace lfm
