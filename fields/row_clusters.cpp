// SPDX-License-Identifier: BSD-3-Clause
#include "fields/row_clusters.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"

namespace lfm {
namespace {

constexpr int64_t kBlock = 16384;  // rows whose choices are held at a time

void TakeBest(const ClusterChoices& choices, int64_t first, RowClusters& result) {
  const int per_row = choices.per_row;
  for (int64_t r = 0; r < choices.rows(); ++r) {
    const int64_t best = r * per_row + choices.Best(r), row = first + r;
    result.cluster[row] = choices.cluster[best];
    result.error[row] = choices.error[best];
    std::copy_n(choices.weights.begin() + best * choices.terms, choices.terms,
                result.weights.begin() + row * result.terms);
  }
  std::copy(choices.cluster.begin(), choices.cluster.end(), result.other.begin() + first * per_row);
  std::copy(choices.error.begin(), choices.error.end(),
            result.other_error.begin() + first * per_row);
}

// The numbers from `first` on, `count` of them.
std::vector<int64_t> Range(int64_t first, int64_t count) {
  std::vector<int64_t> range(static_cast<size_t>(count));
  std::iota(range.begin(), range.end(), first);
  return range;
}

// t x m, unit norm each, without those that are zero.
FunctionRows UnitFunctions(const std::vector<float>& functions_by_column, int64_t terms,
                           int columns) {
  Eigen::MatrixXd f =
      Eigen::Map<const Eigen::MatrixXf>(functions_by_column.data(), terms, columns).cast<double>();
  std::vector<int64_t> kept;
  for (int64_t t = 0; t < terms; ++t) {
    const double norm = f.row(t).norm();
    if (!(norm > 0) || !std::isfinite(norm)) continue;
    f.row(t) /= norm;
    kept.push_back(t);
  }
  FunctionRows basis = MakeFunctionRows(static_cast<int64_t>(kept.size()), columns);
  for (int64_t t = 0; t < basis.rows; ++t) {
    Eigen::Map<Eigen::RowVectorXf>(basis.Row(t), columns) = f.row(kept[t]).cast<float>();
  }
  return basis;
}

}  // namespace

FunctionRows ActiveRows::Gather(std::span<const int64_t> active) const {
  std::vector<int64_t> rows(active.size());
  std::transform(active.begin(), active.end(), rows.begin(), [&](int64_t i) { return which[i]; });
  return GatherRows(all, rows);
}

ActiveRows RowsWithEnergy(RowsView all) {
  std::vector<char> lit(static_cast<size_t>(all.rows));
  ParallelFor(
      0, all.rows,
      [&](int64_t r) {
        const float* row = all.Row(r);
        lit[r] = std::any_of(row, row + all.columns, [](float v) { return v != 0; }) ? 1 : 0;
      },
      1024);
  ActiveRows rows{all, {}};
  for (int64_t r = 0; r < all.rows; ++r) {
    if (lit[r] != 0) rows.which.push_back(r);
  }
  return rows;
}

double RowClusters::TotalError() const { return std::accumulate(error.begin(), error.end(), 0.0); }

std::vector<std::vector<int64_t>> MembersOf(const RowClusters& rows, size_t clusters) {
  std::vector<std::vector<int64_t>> members(clusters);
  for (size_t i = 0; i < rows.cluster.size(); ++i) {
    members[rows.cluster[i]].push_back(static_cast<int64_t>(i));
  }
  return members;
}

RowClusters ChooseClusters(const ActiveRows& rows, const std::vector<FunctionRows>& bases,
                           const std::vector<uint16_t>& now, const AllowedClusters& allowed,
                           const ClusterChoiceOptions& options, Progress& progress) {
  const int64_t count = rows.count();
  const int alternatives = options.alternatives;
  RowClusters result;
  result.terms = options.terms;
  result.cluster.assign(static_cast<size_t>(count), 0);
  result.error.assign(static_cast<size_t>(count), 0);
  result.weights.assign(static_cast<size_t>(count * result.terms), 0);
  result.alternatives = alternatives;
  result.other.assign(static_cast<size_t>(count * alternatives), kNoCluster);
  result.other_error.assign(static_cast<size_t>(count * alternatives), 0);
  const ClusterRanking ranking(bases);
  for (int64_t first = 0; first < count; first += kBlock) {
    const std::vector<int64_t> range = Range(first, std::min(kBlock, count - first));
    const FunctionRows block = rows.Gather(range);
    const std::vector<uint16_t> keep(
        now.begin() + std::min<int64_t>(first, std::ssize(now)),
        now.begin() + std::min<int64_t>(first + std::ssize(range), std::ssize(now)));
    AllowedClusters allowed_here;
    if (allowed) allowed_here = [&](int64_t r) { return allowed(first + r); };
    ClusterChoices choices = ranking.Rank(block.View(), alternatives, keep, allowed_here);
    SolveChoices(block.View(), bases, options.l1, choices);
    TakeBest(choices, first, result);
    progress.Advance(std::ssize(range));
  }
  return result;
}

SparseFactors FactorizeMembers(const ActiveRows& rows, std::span<const int64_t> members,
                               const SparseFactorizationOptions& options) {
  const FunctionRows functions = rows.Gather(members);
  SparseFactors factors = FactorizeSparse(functions.View(), options);
  if (factors.basis.rows > 0) return factors;
  // So sparse that leaving all of it over costs least: one of the rows stands for the cluster.
  const std::vector<float> first(functions.Row(0), functions.Row(0) + functions.columns);
  factors.basis = UnitFunctions(first, 1, functions.columns);
  factors.weights = SolveL1(factors.basis.View(), functions.View(), options.l1).weights;
  return factors;
}

std::vector<FunctionRows> RefitBases(const ActiveRows& rows, const RowClusters& clusters,
                                     const std::vector<FunctionRows>& bases, const L1Options& l1) {
  const auto members = MembersOf(clusters, bases.size());
  std::vector<FunctionRows> refitted(bases.size());
  ParallelFor(0, static_cast<int64_t>(bases.size()), [&](int64_t k) {
    const int64_t terms = bases[k].rows;
    const auto count = static_cast<int64_t>(members[k].size());
    if (count == 0 || terms == 0) {
      refitted[k] = MakeFunctionRows(0, rows.all.columns);
      return;
    }
    FunctionRows weights = MakeFunctionRows(terms, static_cast<int>(count));
    for (int64_t i = 0; i < count; ++i) {
      const float* from = clusters.weights.data() + members[k][i] * clusters.terms;
      for (int64_t t = 0; t < terms; ++t) weights.Row(t)[i] = from[t];
    }
    const FunctionRows columns = TransposeRows(rows.Gather(members[k]).View());
    refitted[k] =
        UnitFunctions(SolveL1(weights.View(), columns.View(), l1).weights, terms, rows.all.columns);
    if (refitted[k].rows == 0) refitted[k] = bases[k];
  });
  return refitted;
}

}  // namespace lfm
