// SPDX-License-Identifier: BSD-3-Clause
#include "fields/sparse_clusters.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/cluster_neighbourhoods.h"
#include "fields/cluster_sizes.h"
#include "fields/cluster_start.h"
#include "fields/coarse_field.h"
#include "fields/residual.h"
#include "fields/row_clusters.h"
#include "fields/stored_numbers.h"

namespace lfm {
namespace {

constexpr int kFirstAlternations = 3;  // of a cluster that is founded
constexpr int kRowsPerCluster = 200;   // that the low resolution keeps at least, on average
constexpr int kLargestFactor = 16;
constexpr double kFewMove = 0.005;    // of the rows
constexpr double kSmallGain = 0.003;  // of the error, in
constexpr size_t kGainRounds = 3;

// Everything that the rounds share.
struct Fit {
  SparseFactorizationOptions found;  // for a new cluster
  L1Options l1;
  ClusterChoiceOptions choice;

  explicit Fit(const SparseClusterOptions& options) {
    l1.solver = options.l1_solver;
    l1.sign = options.residual_sign;
    found.terms = options.terms;
    found.start = options.factor_start;
    found.max_alternations = kFirstAlternations;
    found.l1 = l1;
    choice = {options.terms, options.alternatives, l1};
  }
};

ClusterSizeLimits Limits(const SparseClusterOptions& options, int64_t rows, int clusters) {
  const double mean = static_cast<double>(rows) / std::max(clusters, 1);
  ClusterSizeLimits limits;
  limits.smallest = std::max<int64_t>(1, static_cast<int64_t>(options.min_cluster * mean));
  limits.largest = std::max<int64_t>(
      2 * limits.smallest, static_cast<int64_t>(std::min(options.max_cluster * mean, 1e18)));
  return limits;
}

ClusterState HoldSizes(const ActiveRows& rows, ClusterState state, const ClusterSizeLimits& limits,
                       const Fit& fit) {
  state = MergeSmallClusters(rows, std::move(state), limits, fit.l1);
  return SplitLargeClusters(rows, std::move(state), limits, fit.found);
}

double RelativeL1(const ActiveRows& rows, const RowClusters& clusters) {
  double magnitude = 0;
  for (int64_t r : rows.which) {
    const float* row = rows.all.Row(r);
    double sum = 0;
    for (int j = 0; j < rows.all.columns; ++j) sum += std::abs(row[j]);
    magnitude += sum;
  }
  return magnitude > 0 ? clusters.TotalError() / magnitude : 0;
}

std::vector<FunctionRows> FirstBases(const ActiveRows& rows, const std::vector<uint16_t>& start,
                                     int clusters, const Fit& fit) {
  RowClusters placed;
  placed.cluster = start;
  const auto members = MembersOf(placed, static_cast<size_t>(clusters));
  std::vector<FunctionRows> bases(static_cast<size_t>(clusters));
  ParallelFor(0, clusters, [&](int64_t k) {
    bases[k] = members[k].empty() ? MakeFunctionRows(0, rows.all.columns)
                                  : FactorizeMembers(rows, members[k], fit.found).basis;
  });
  return bases;
}

int Inhabited(const ClusterState& state) {
  const auto members = MembersOf(state.rows, state.bases.size());
  return static_cast<int>(std::count_if(members.begin(), members.end(),
                                        [](const auto& some) { return !some.empty(); }));
}

int64_t Moved(const std::vector<uint16_t>& before, const std::vector<uint16_t>& after) {
  int64_t moved = 0;
  for (size_t i = 0; i < after.size(); ++i) moved += before[i] != after[i] ? 1 : 0;
  return moved;
}

bool HasSettled(const std::vector<double>& errors) {
  if (errors.size() <= kGainRounds) return false;
  const double before = errors[errors.size() - 1 - kGainRounds];
  return before - errors.back() < kSmallGain * before;
}

// Bootstraps the clusters at low resolution.
ClusterState Bootstrap(const ActiveRows& rows, const SparseClusterOptions& options, const Fit& fit,
                       SparseClusterResult& result, Progress& progress) {
  const int clusters = static_cast<int>(std::min<int64_t>(options.clusters, rows.count()));
  const ClusterSizeLimits limits = Limits(options, rows.count(), clusters);
  std::vector<uint16_t> now = options.cluster_start == ClusterStart::kRandom
                                  ? RandomClusters(rows.count(), clusters)
                                  : SimilarClusters(rows, clusters);
  ClusterState state{FirstBases(rows, now, clusters, fit), {}};
  progress.Start("clusters at low resolution", rows.count() * (options.rounds + 1));
  for (int round = 0;; ++round) {
    state.rows = ChooseClusters(rows, state.bases, now, nullptr, fit.choice, progress);
    const double share_moved =
        static_cast<double>(Moved(now, state.rows.cluster)) / static_cast<double>(rows.count());
    result.bootstrap_error.push_back(RelativeL1(rows, state.rows));
    state = HoldSizes(rows, std::move(state), limits, fit);
    state = SplitWorstClusters(rows, std::move(state), clusters, limits, fit.found);
    if (round >= options.rounds || share_moved < kFewMove || HasSettled(result.bootstrap_error)) {
      return state;
    }
    now = state.rows.cluster;
    state.bases = RefitBases(rows, state.rows, state.bases, fit.l1);
  }
}

bool HasPlaces(const Field& field) { return field.width > 0 || !field.positions.empty(); }

int ChooseFactor(const Field& field, int64_t active, const SparseClusterOptions& options) {
  if (!HasPlaces(field)) return 1;
  if (options.bootstrap_factor > 0) return options.bootstrap_factor;
  const double enough = double{kRowsPerCluster} * options.clusters;
  const double factor = std::floor(std::sqrt(static_cast<double>(active) / enough));
  return static_cast<int>(std::clamp<double>(factor, 1, kLargestFactor));
}

// The clusters found at low resolution, given to all rows and fitted to them.
ClusterState AtFullResolution(const Field& field, const ActiveRows& rows,
                              const SparseClusterOptions& options, const Fit& fit,
                              SparseClusterResult& result, Progress& progress) {
  result.bootstrap_factor = ChooseFactor(field, rows.count(), options);
  CoarseField coarse = MakeCoarseField(field, result.bootstrap_factor);
  if (RowsWithEnergy(coarse.rows.View()).count() == 0) {  // neighbours cancel each other
    result.bootstrap_factor = 1;
    coarse = MakeCoarseField(field, 1);
  }
  ClusterNeighbourhoods near(field, coarse);
  ClusterState state;
  {
    const ActiveRows coarse_rows = RowsWithEnergy(coarse.rows.View());
    result.bootstrap_rows = coarse_rows.count();
    state = Bootstrap(coarse_rows, options, fit, result, progress);
    near.SetFromCells(coarse_rows.which, state.rows.cluster, state.bases.size());
  }
  coarse.rows = {};
  AllowedClusters allowed;
  if (HasPlaces(field)) allowed = [&](int64_t i) { return near.Of(rows.which[i]); };
  const ClusterSizeLimits limits = Limits(options, rows.count(), Inhabited(state));
  result.smallest_allowed = limits.smallest;
  result.largest_allowed = limits.largest;
  std::vector<uint16_t> now;
  progress.Start("clusters at full resolution", rows.count() * (options.refine + 1));
  for (int round = 0;; ++round) {
    state.rows = ChooseClusters(rows, state.bases, now, allowed, fit.choice, progress);
    result.full_error.push_back(RelativeL1(rows, state.rows));
    state = HoldSizes(rows, std::move(state), limits, fit);
    if (round >= options.refine) return state;
    now = state.rows.cluster;
    near.SetFromRows(rows.which, now, state.bases.size());
    state.bases = RefitBases(rows, state.rows, state.bases, fit.l1);
  }
}

// The clusters that have members, renumbered, as a model whose bases are rounded already; rows
// without energy in a cluster behind.
ClusteredModel EmptyModel(const ActiveRows& rows, const ClusterState& state) {
  ClusteredModel model;
  model.rows = rows.all.rows;
  model.columns = rows.all.columns;
  const auto members = MembersOf(state.rows, state.bases.size());
  std::vector<uint16_t> number(state.bases.size());
  for (size_t k = 0; k < members.size(); ++k) {
    if (members[k].empty()) continue;
    number[k] = static_cast<uint16_t>(model.bases.size());
    model.bases.push_back(state.bases[k]);
  }
  const auto dark = static_cast<uint16_t>(model.bases.size());
  if (rows.count() < rows.all.rows) model.bases.push_back(MakeFunctionRows(0, model.columns));
  model.cluster.assign(static_cast<size_t>(model.rows), dark);
  for (int64_t i = 0; i < rows.count(); ++i) {
    model.cluster[rows.which[i]] = number[state.rows.cluster[i]];
  }
  return RoundToStored(std::move(model));
}

// Weights for the bases as they stand, rounded.
ClusteredModel WithWeights(ClusteredModel model, const ActiveRows& rows, const Fit& fit) {
  std::vector<uint16_t> own(static_cast<size_t>(rows.count()));
  for (int64_t i = 0; i < rows.count(); ++i) own[i] = model.cluster[rows.which[i]];
  ClusterChoiceOptions choice = fit.choice;
  choice.alternatives = 1;
  const RowClusters solved = ChooseClusters(
      rows, model.bases, own, [&](int64_t i) { return std::span<const uint16_t>(&own[i], 1); },
      choice, SilentProgress());
  model.first_weight.assign(static_cast<size_t>(model.rows), 0);
  int64_t active = 0;
  for (int64_t r = 0; r < model.rows; ++r) {
    model.first_weight[r] = static_cast<int64_t>(model.weights.size());
    if (active == rows.count() || rows.which[active] != r) continue;
    const float* weights = solved.weights.data() + active++ * solved.terms;
    model.weights.insert(model.weights.end(), weights, weights + model.Terms(r));
  }
  return RoundToStored(std::move(model));
}

void CountSizes(const ActiveRows& rows, SparseClusterResult& result) {
  const ClusteredModel& model = result.model;
  std::vector<int64_t> sizes(model.bases.size());
  for (int64_t r : rows.which) ++sizes[model.cluster[r]];
  result.dark_rows = model.rows - rows.count();
  if (result.dark_rows > 0) sizes.pop_back();
  result.clusters = static_cast<int>(sizes.size());
  if (sizes.empty()) return;
  result.smallest_cluster = *std::min_element(sizes.begin(), sizes.end());
  result.largest_cluster = *std::max_element(sizes.begin(), sizes.end());
  result.residuals_per_row =
      static_cast<double>(model.residual_value.size()) / static_cast<double>(rows.count());
}

SparseClusterResult Cluster(const Field& field, const SparseClusterOptions& options,
                            Progress& progress) {
  SparseClusterResult result;
  const Fit fit(options);
  const ActiveRows rows = RowsWithEnergy(field.functions.View());
  ClusterState state;
  if (rows.count() > 0) {
    state = AtFullResolution(field, rows, options, fit, result, progress);
  }
  result.model = WithWeights(EmptyModel(rows, state), rows, fit);
  state = {};
  result.model = WithResidual(std::move(result.model), rows.all,
                              {options.residuals, options.residual_threshold});
  CountSizes(rows, result);
  return result;
}

}  // namespace

SparseClusterResult ClusterSparse(const Field& field, const SparseClusterOptions& options,
                                  Progress& progress) {
  SparseClusterOptions checked = options;
  ValidateOptions(AnyOptions(checked));
  RequireFinite(field.functions.View(), field.name.c_str());
  if (options.functions_basis == FunctionsBasis::kNone) return Cluster(field, options, progress);
  const HaarBasis haar = MakeHaarBasis(field.directions);
  Field transformed;
  transformed.name = field.name;
  transformed.points = field.points;
  transformed.channels = field.channels;
  transformed.width = field.width;
  transformed.height = field.height;
  transformed.positions = field.positions;
  transformed.functions = ToHaar(haar, field.functions);
  SparseClusterResult result = Cluster(transformed, options, progress);
  result.haar = haar;
  return result;
}

}  // namespace lfm
