// SPDX-License-Identifier: BSD-3-Clause
#include "fields/cpca.h"

#include <limits>
#include <utility>

#include "core/error.h"
#include "fields/block_pca.h"
#include "fields/clustered_pca.h"
#include "fields/matrix_products.h"
#include "fields/wavelet_reduction.h"

namespace lfm {
namespace {

constexpr int64_t kSample = 3000;  // rows that N is estimated from

double GlobalTermsOf(RowsView rows, const CpcaOptions& options) {
  if (options.global_terms > 0) return options.global_terms;
  return static_cast<double>(GlobalTerms(rows, kSample, options.energy_percent / 100));
}

Clustering DivideRows(RowsView full, const CpcaOptions& options, double global_terms) {
  FunctionRows reduced;
  RowsView seen = full;
  if (options.wavelets > 0 && options.wavelets < full.columns) {
    reduced = ReduceByWavelets(full, GridOfColumns(full.columns), options.wavelets).rows;
    seen = reduced.View();
  }
  if (options.division == CpcaDivision::kFixed) {
    return ClusterRows(seen, {.clusters = options.clusters,
                              .terms = options.search_terms,
                              .min_rows = options.min_rows});
  }
  return DivideClusters(full, seen,
                        {.initial_clusters = options.initial_clusters,
                         .energy_share = options.energy_percent / 100,
                         .global_terms = global_terms,
                         .full_rows = options.full_rows,
                         .search_terms = options.search_terms,
                         .min_rows = options.min_rows})
      .clustering;
}

// Rows that show nothing have a last cluster, without functions.
Clustering ByRows(RowsView full, const CpcaOptions& options, double global_terms) {
  const std::vector<double> energies = RowEnergies(full);
  std::vector<int64_t> lit;
  for (int64_t row = 0; row < full.rows; ++row) {
    if (energies[row] > 0) lit.push_back(row);
  }
  if (static_cast<int64_t>(lit.size()) == full.rows) {
    return DivideRows(full, options, global_terms);
  }
  Clustering part;
  if (!lit.empty()) {
    part = DivideRows(GatherRows(full, lit).View(), options, global_terms);
  }
  Clustering all{part.clusters + 1, std::vector<int>(energies.size(), part.clusters)};
  for (size_t i = 0; i < lit.size(); ++i) all.cluster[lit[i]] = part.cluster[i];
  return all;
}

void RequireFewBlocks(const Field& field, int side) {
  constexpr int64_t kMostClusters = 65536;
  const auto along = [side](int length) { return (int64_t{length} + side - 1) / side; };
  const int64_t blocks = along(field.width) * along(field.height) * field.channels;
  if (blocks > kMostClusters) {
    throw Error(field.name + ": blocks of " + std::to_string(side) + " pixels are " +
                std::to_string(blocks) + " clusters, more than 65536; take a larger --cpca-block");
  }
}

Clustering ByBlocks(const Field& field, const CpcaOptions& options, double global_terms) {
  if (field.width < 1 || int64_t{field.width} * field.height != field.points) {
    throw Error(field.name + ": blocks need a picture");
  }
  RequireFewBlocks(field, options.block);
  const BlockOptions blocks = {options.energy_percent / 100, global_terms};
  Clustering all;
  for (int channel = 0; channel < field.channels; ++channel) {
    const RowsView rows = {field.functions.Row(field.RowOf(0, channel)), field.points,
                           field.functions.columns, field.functions.stride};
    const RowsOfPicture picture = OccupiedPixels(rows, field.width, field.height);
    const BlockDivision division =
        options.division == CpcaDivision::kBlocks
            ? FixedBlocks(rows, picture, options.block, blocks)
            : DivideBlocks(rows, picture, {.largest = options.block, .blocks = blocks});
    for (const int cluster : division.clustering.cluster) {
      all.cluster.push_back(all.clusters + cluster);
    }
    all.clusters += division.clustering.clusters;
  }
  return all;
}

}  // namespace

CpcaResult EncodeClusteredPca(const Field& field, const CpcaOptions& options) {
  CpcaOptions checked = options;
  ValidateOptions(AnyOptions(checked));
  const RowsView rows = field.functions.View();
  if (rows.rows != field.points * field.channels) {
    throw Error(field.name + ": a row for every point and channel is needed");
  }
  CpcaResult result;
  result.model.columns = rows.columns;
  if (rows.rows == 0) return result;
  RequireFinite(rows, field.name.c_str());
  result.global_terms = GlobalTermsOf(rows, options);
  const bool by_blocks =
      options.division == CpcaDivision::kBlocks || options.division == CpcaDivision::kQuadtree;
  const Clustering clustering = by_blocks ? ByBlocks(field, options, result.global_terms)
                                          : ByRows(rows, options, result.global_terms);
  const int most = options.max_terms > 0 ? options.max_terms : std::numeric_limits<int>::max();
  result.model = ModelOfClusters(rows, clustering,
                                 {.max_terms = most, .energy_share = options.energy_percent / 100});
  result.sizes = SizesOf(result.model);
  result.cost = CostOf(result.sizes, result.global_terms);
  return result;
}

}  // namespace lfm
