// SPDX-License-Identifier: BSD-3-Clause
#include "fields/clustered_pca.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/matrix_products.h"
#include "fields/row_assignment.h"

namespace lfm {
namespace {

void CheckOptions(const ClusterSearchOptions& options) {
  if (options.clusters < 1 || options.terms < 1 || options.iterations < 0 || options.min_rows < 1 ||
      !(options.tolerance >= 0)) {
    throw Error("clustered PCA: an option is out of range");
  }
}

std::vector<std::vector<int64_t>> MembersOf(const std::vector<int>& cluster, int clusters) {
  std::vector<std::vector<int64_t>> members(static_cast<size_t>(clusters));
  for (size_t row = 0; row < cluster.size(); ++row) {
    members[cluster[row]].push_back(static_cast<int64_t>(row));
  }
  return members;
}

std::vector<FunctionRows> BasesOf(RowsView rows, const std::vector<std::vector<int64_t>>& members,
                                  int terms) {
  std::vector<FunctionRows> bases(members.size());
  ParallelFor(0, static_cast<int64_t>(members.size()), [&](int64_t c) {
    bases[c] = TermsOf(GatherRows(rows, members[c]).View(), {.max_terms = terms}).functions;
  });
  return bases;
}

// Clusters without rows begin again at rows that are approximated worst, each of another cluster.
void RefillEmpty(const std::vector<double>& energies, RowAssignment& assignment, int clusters) {
  std::vector<int64_t> sizes(static_cast<size_t>(clusters));
  for (const int c : assignment.cluster) ++sizes[c];
  if (std::find(sizes.begin(), sizes.end(), 0) == sizes.end()) return;
  std::vector<int64_t> worst(energies.size());
  std::iota(worst.begin(), worst.end(), 0);
  const auto left = [&](int64_t row) { return energies[row] - assignment.held[row]; };
  std::stable_sort(worst.begin(), worst.end(),
                   [&](int64_t a, int64_t b) { return left(a) > left(b); });
  std::vector<char> drawn_from(sizes.size());
  size_t next = 0;
  for (int c = 0; c < clusters; ++c) {
    if (sizes[c] > 0) continue;
    for (; next < worst.size(); ++next) {
      const int from = assignment.cluster[worst[next]];
      if (sizes[from] > 1 && drawn_from[from] == 0 && left(worst[next]) > 0) break;
    }
    if (next == worst.size()) return;
    const int from = assignment.cluster[worst[next]];
    drawn_from[from] = drawn_from[c] = 1;
    --sizes[from];
    ++sizes[c];
    assignment.cluster[worst[next]] = c;
    assignment.held[worst[next]] = energies[worst[next]];
  }
}

double ErrorOf(const std::vector<double>& energies, const RowAssignment& assignment) {
  double error = 0;
  for (size_t row = 0; row < energies.size(); ++row) {
    error += std::max(0.0, energies[row] - assignment.held[row]);
  }
  return error;
}

std::vector<FunctionRows> LinesThrough(RowsView rows, const std::vector<int64_t>& seeds) {
  std::vector<std::vector<int64_t>> members;
  for (const int64_t seed : seeds) members.push_back({seed});
  return BasesOf(rows, members, 1);
}

// Numbers without gaps, in order.
Clustering Compact(std::vector<int> cluster) {
  Clustering result;
  std::vector<int> number;
  for (const int c : cluster) {
    if (c >= static_cast<int>(number.size())) number.resize(c + 1, -1);
    number[c] = 0;
  }
  for (int& n : number) {
    if (n == 0) n = result.clusters++;
  }
  for (int& c : cluster) c = number[c];
  result.cluster = std::move(cluster);
  return result;
}

// Rows of clusters that are too small go where they fit next best; the largest always stays.
void DissolveSmall(RowsView rows, const std::vector<double>& energies, int64_t min_rows, int terms,
                   int clusters, std::vector<int>& cluster) {
  const std::vector<std::vector<int64_t>> members = MembersOf(cluster, clusters);
  const auto largest =
      std::max_element(members.begin(), members.end(),
                       [](const auto& a, const auto& b) { return a.size() < b.size(); });
  std::vector<std::vector<int64_t>> kept;
  std::vector<int> number;
  std::vector<int64_t> loose;
  for (auto m = members.begin(); m != members.end(); ++m) {
    if (m == largest || static_cast<int64_t>(m->size()) >= min_rows) {
      kept.push_back(*m);
      number.push_back(static_cast<int>(m - members.begin()));
    } else {
      loose.insert(loose.end(), m->begin(), m->end());
    }
  }
  if (loose.empty()) return;
  std::vector<double> loose_energies;
  for (const int64_t row : loose) loose_energies.push_back(energies[row]);
  const RowAssignment next =
      AssignRows(GatherRows(rows, loose).View(), loose_energies, BasesOf(rows, kept, terms), {});
  for (size_t i = 0; i < loose.size(); ++i) cluster[loose[i]] = number[next.cluster[i]];
}

}  // namespace

std::vector<std::vector<int64_t>> Clustering::Members() const {
  return MembersOf(cluster, clusters);
}

Clustering ClusterRows(RowsView rows, const ClusterSearchOptions& options) {
  CheckOptions(options);
  const std::vector<double> energies = RowEnergies(rows);
  const double total = std::accumulate(energies.begin(), energies.end(), 0.0);
  if (!std::isfinite(total)) RequireFinite(rows, "rows to be clustered");
  if (rows.rows == 0) return {};
  const std::vector<int64_t> seeds = SeedRows(rows, energies, options.clusters);
  const int clusters = std::max(1, static_cast<int>(seeds.size()));
  if (clusters == 1) return {1, std::vector<int>(energies.size())};
  RowAssignment assignment = AssignRows(rows, energies, LinesThrough(rows, seeds), {});
  double error = ErrorOf(energies, assignment);
  for (int i = 0; i < options.iterations; ++i) {
    RefillEmpty(energies, assignment, clusters);
    const std::vector<FunctionRows> bases =
        BasesOf(rows, MembersOf(assignment.cluster, clusters), options.terms);
    assignment = AssignRows(rows, energies, bases, assignment.cluster);
    const double now = ErrorOf(energies, assignment);
    const bool settled = error - now <= options.tolerance * error;
    error = now;
    if (settled && i > 0) break;
  }
  DissolveSmall(rows, energies, options.min_rows, options.terms, clusters, assignment.cluster);
  return Compact(std::move(assignment.cluster));
}

ClusteredModel ModelOfClusters(RowsView rows, const Clustering& clustering,
                               const TermsOptions& terms) {
  constexpr int kMostClusters = 65536;
  if (clustering.clusters > kMostClusters) throw Error("clustered PCA: more than 65536 clusters");
  if (static_cast<int64_t>(clustering.cluster.size()) != rows.rows) {
    throw Error("clustered PCA: clusters of another number of rows");
  }
  if (terms.centring != Centring::kNone) {
    throw Error("clustered PCA: a clustered model has no place for means");
  }
  const std::vector<std::vector<int64_t>> members = clustering.Members();
  ClusteredModel model;
  model.rows = rows.rows;
  model.columns = rows.columns;
  model.cluster.assign(clustering.cluster.begin(), clustering.cluster.end());
  model.bases.resize(members.size());
  std::vector<std::vector<float>> weights(members.size());
  ParallelFor(0, static_cast<int64_t>(members.size()), [&](int64_t c) {
    const FunctionRows part = GatherRows(rows, members[c]);
    model.bases[c] = TermsOf(part.View(), terms).functions;
    weights[c] = CoefficientsOf(part.View(), model.bases[c].View());
  });
  model.first_weight.resize(static_cast<size_t>(rows.rows));
  int64_t count = 0;
  for (int64_t row = 0; row < rows.rows; ++row) {
    model.first_weight[row] = count;
    count += model.Terms(row);
  }
  model.weights.resize(static_cast<size_t>(count));
  for (size_t c = 0; c < members.size(); ++c) {
    const int64_t n = model.bases[c].rows;
    for (size_t i = 0; i < members[c].size(); ++i) {
      std::copy_n(weights[c].data() + i * n, n,
                  model.weights.data() + model.first_weight[members[c][i]]);
    }
  }
  return model;
}

std::vector<PatchSize> SizesOf(const ClusteredModel& model) {
  std::vector<PatchSize> sizes(model.bases.size());
  for (size_t c = 0; c < sizes.size(); ++c) sizes[c].terms = model.bases[c].rows;
  for (const uint16_t c : model.cluster) ++sizes[c].pixels;
  return sizes;
}

std::vector<PatchSize> MeasureClusters(RowsView rows, const Clustering& clustering,
                                       const TermsOptions& terms) {
  const std::vector<std::vector<int64_t>> members = clustering.Members();
  std::vector<PatchSize> sizes(members.size());
  ParallelFor(0, static_cast<int64_t>(members.size()), [&](int64_t c) {
    sizes[c].pixels = static_cast<int64_t>(members[c].size());
    sizes[c].terms = static_cast<int64_t>(
        TermEnergiesOf(GatherRows(rows, members[c]).View(), terms).energies.size());
  });
  return sizes;
}

}  // namespace lfm
