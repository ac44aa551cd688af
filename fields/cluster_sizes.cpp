// SPDX-License-Identifier: BSD-3-Clause
#include "fields/cluster_sizes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>

namespace lfm {
namespace {

using Members = std::vector<std::vector<int64_t>>;

void Empty(FunctionRows& basis) { basis = MakeFunctionRows(0, basis.columns); }

void Place(RowClusters& rows, int64_t row, uint16_t cluster, float error,
           std::span<const float> weights) {
  rows.cluster[row] = cluster;
  rows.error[row] = error;
  float* out = rows.weights.data() + row * rows.terms;
  std::fill_n(out, rows.terms, 0.0f);
  std::copy(weights.begin(), weights.end(), out);
}

// The best of the row's alternatives that is still there.
uint16_t NextBest(const ClusterState& state, int64_t row) {
  uint16_t best = kNoCluster;
  float least = std::numeric_limits<float>::infinity();
  const int count = state.rows.alternatives;
  for (int i = 0; i < count; ++i) {
    const uint16_t k = state.rows.other[row * count + i];
    const float error = state.rows.other_error[row * count + i];
    if (k == kNoCluster || state.bases[k].rows == 0 || !(error < least)) continue;
    best = k;
    least = error;
  }
  return best;
}

// Rows with one cluster each to go to, or any when that is kNoCluster.
void SendTo(const ActiveRows& rows, ClusterState& state, const std::vector<int64_t>& who,
            const std::vector<uint16_t>& where, const L1Options& l1) {
  constexpr int kAny = 4;
  const FunctionRows functions = rows.Gather(who);
  const ClusterRanking ranking(state.bases);
  std::vector<uint16_t> anywhere(state.bases.size());
  std::iota(anywhere.begin(), anywhere.end(), uint16_t{0});
  ClusterChoices choices = ranking.Rank(functions.View(), kAny, {}, [&](int64_t i) {
    return where[i] == kNoCluster ? std::span<const uint16_t>(anywhere)
                                  : std::span<const uint16_t>(&where[i], 1);
  });
  SolveChoices(functions.View(), state.bases, l1, choices);
  for (size_t i = 0; i < who.size(); ++i) {
    const int64_t best = static_cast<int64_t>(i) * kAny + choices.Best(static_cast<int64_t>(i));
    Place(state.rows, who[i], choices.cluster[best], choices.error[best],
          {choices.weights.data() + best * choices.terms, static_cast<size_t>(choices.terms)});
  }
}

// By the weights' direction of most variance; ties by number.
std::vector<int64_t> OrderAlongWeights(const RowClusters& rows,
                                       const std::vector<int64_t>& members) {
  const auto count = static_cast<int64_t>(members.size());
  Eigen::MatrixXd weights(count, std::max(rows.terms, 1));
  weights.setZero();
  for (int64_t i = 0; i < count; ++i) {
    for (int t = 0; t < rows.terms; ++t) {
      weights(i, t) = rows.weights[members[i] * rows.terms + t];
    }
    weights.row(i).stableNormalize();
  }
  weights.rowwise() -= weights.colwise().mean().eval();
  const Eigen::MatrixXd spread = weights.transpose() * weights;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(spread);
  const Eigen::VectorXd along = weights * solver.eigenvectors().rightCols(1);
  std::vector<int64_t> order(members.size());
  std::iota(order.begin(), order.end(), int64_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](int64_t a, int64_t b) { return along[a] < along[b]; });
  std::vector<int64_t> ordered(members.size());
  std::transform(order.begin(), order.end(), ordered.begin(),
                 [&](int64_t i) { return members[i]; });
  return ordered;
}

// A cluster of these rows alone.
void Found(const ActiveRows& rows, ClusterState& state, uint16_t cluster,
           std::vector<int64_t> members, const SparseFactorizationOptions& options) {
  std::sort(members.begin(), members.end());
  SparseFactors factors = FactorizeMembers(rows, members, options);
  const int64_t terms = factors.basis.rows;
  for (size_t i = 0; i < members.size(); ++i) {
    const std::span<const float> weights(factors.weights.data() + static_cast<int64_t>(i) * terms,
                                         static_cast<size_t>(terms));
    Place(state.rows, members[i], cluster, 0, weights);
  }
  const FunctionRows functions = rows.Gather(members);
  for (size_t i = 0; i < members.size(); ++i) {
    const std::vector<float> weights(factors.weights.begin() + static_cast<int64_t>(i) * terms,
                                     factors.weights.begin() + static_cast<int64_t>(i + 1) * terms);
    const RowsView one{functions.Row(static_cast<int64_t>(i)), 1, functions.columns,
                       functions.stride};
    state.rows.error[members[i]] = static_cast<float>(L1Error(factors.basis.View(), weights, one));
  }
  state.bases[cluster] = std::move(factors.basis);
}

std::optional<uint16_t> FreeNumber(ClusterState& state, const Members& members,
                                   const ClusterSizeLimits& limits) {
  for (size_t k = 0; k < members.size(); ++k) {
    if (members[k].empty()) return static_cast<uint16_t>(k);
  }
  if (static_cast<int>(state.bases.size()) >= limits.most_clusters) return std::nullopt;
  state.bases.push_back(MakeFunctionRows(0, state.bases.front().columns));
  return static_cast<uint16_t>(state.bases.size() - 1);
}

void Halve(const ActiveRows& rows, ClusterState& state, Members& members, size_t cluster,
           uint16_t other, const SparseFactorizationOptions& options) {
  const std::vector<int64_t> order = OrderAlongWeights(state.rows, members[cluster]);
  const auto middle = order.begin() + std::ssize(order) / 2;
  members.resize(state.bases.size());
  members[cluster].assign(order.begin(), middle);
  members[other].assign(middle, order.end());
  Found(rows, state, static_cast<uint16_t>(cluster), members[cluster], options);
  Found(rows, state, other, members[other], options);
}

}  // namespace

ClusterState MergeSmallClusters(const ActiveRows& rows, ClusterState state,
                                const ClusterSizeLimits& limits, const L1Options& l1) {
  for (;;) {
    const Members members = MembersOf(state.rows, state.bases.size());
    size_t smallest = members.size(), inhabited = 0;
    for (size_t k = 0; k < members.size(); ++k) {
      if (members[k].empty()) {
        Empty(state.bases[k]);
        continue;
      }
      ++inhabited;
      if (smallest == members.size() || members[k].size() < members[smallest].size()) smallest = k;
    }
    if (inhabited <= 1 || std::ssize(members[smallest]) >= limits.smallest) return state;
    Empty(state.bases[smallest]);
    std::vector<uint16_t> where;
    for (int64_t row : members[smallest]) where.push_back(NextBest(state, row));
    SendTo(rows, state, members[smallest], where, l1);
  }
}

ClusterState SplitLargeClusters(const ActiveRows& rows, ClusterState state,
                                const ClusterSizeLimits& limits,
                                const SparseFactorizationOptions& options) {
  Members members = MembersOf(state.rows, state.bases.size());
  for (;;) {
    const auto largest =
        std::max_element(members.begin(), members.end(),
                         [](const auto& a, const auto& b) { return a.size() < b.size(); });
    if (largest == members.end() || std::ssize(*largest) <= limits.largest) return state;
    const std::optional<uint16_t> other = FreeNumber(state, members, limits);
    if (!other) return state;
    Halve(rows, state, members, static_cast<size_t>(largest - members.begin()), *other, options);
  }
}

ClusterState SplitWorstClusters(const ActiveRows& rows, ClusterState state, int wanted,
                                const ClusterSizeLimits& limits,
                                const SparseFactorizationOptions& options) {
  Members members = MembersOf(state.rows, state.bases.size());
  for (;;) {
    int inhabited = 0;
    double worst_error = -1;
    size_t worst = 0;
    for (size_t k = 0; k < members.size(); ++k) {
      inhabited += members[k].empty() ? 0 : 1;
      if (std::ssize(members[k]) < std::max<int64_t>(2, 2 * limits.smallest)) continue;
      double error = 0;
      for (int64_t row : members[k]) error += state.rows.error[row];
      if (error <= worst_error) continue;
      worst_error = error;
      worst = k;
    }
    if (inhabited >= wanted || worst_error < 0) return state;
    const std::optional<uint16_t> other = FreeNumber(state, members, limits);
    if (!other) return state;
    Halve(rows, state, members, worst, *other, options);
  }
}

}  // namespace lfm
