// SPDX-License-Identifier: BSD-3-Clause
#include "fields/cluster_choice.h"

#include <Eigen/Core>
#include <algorithm>
#include <limits>

#include "core/parallel.h"
#include "fields/orthonormal_basis.h"

namespace lfm {
namespace {

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using ConstMatrix = Eigen::Map<const Matrix, 0, Eigen::OuterStride<>>;
using ConstRow = Eigen::Map<const Eigen::RowVectorXf>;

constexpr int64_t kChunk = 128;

struct Scored {
  float energy = 0;
  uint16_t cluster = kNoCluster;
};

bool Better(const Scored& a, const Scored& b) {
  return a.energy != b.energy ? a.energy > b.energy : a.cluster < b.cluster;
}

// `scored`, best first, into one row's places; `keep` takes the last when it is not among them.
void FillChoices(std::vector<Scored>& scored, uint16_t keep, std::span<uint16_t> places) {
  const auto wanted = static_cast<ptrdiff_t>(std::min(scored.size(), places.size()));
  std::partial_sort(scored.begin(), scored.begin() + wanted, scored.end(), Better);
  for (ptrdiff_t i = 0; i < wanted; ++i) places[i] = scored[i].cluster;
  if (keep == kNoCluster || std::find(places.begin(), places.end(), keep) != places.end()) return;
  places[std::min<size_t>(static_cast<size_t>(wanted), places.size() - 1)] = keep;
}

// Scales to a largest magnitude near 1, so that squares stay in float32's range.
float UnitScale(const float* row, int columns) {
  const float largest = ConstRow(row, columns).cwiseAbs().maxCoeff();
  return largest > 0 ? 1 / std::max(largest, 1e-37f) : 0;
}

}  // namespace

int ClusterChoices::Best(int64_t row) const {
  const float* errors = error.data() + row * per_row;
  return static_cast<int>(std::min_element(errors, errors + per_row) - errors);
}

ClusterRanking::ClusterRanking(const std::vector<FunctionRows>& bases) {
  std::vector<Eigen::MatrixXd> functions(bases.size());
  ParallelFor(0, static_cast<int64_t>(bases.size()), [&](int64_t k) {
    if (bases[k].rows > 0) functions[k] = Orthonormalize(bases[k].View()).functions;
  });
  first_.push_back(0);
  for (const Eigen::MatrixXd& some : functions) {
    if (some.rows() > 0) columns_ = static_cast<int>(some.cols());
    first_.push_back(first_.back() + static_cast<int>(some.rows()));
  }
  stacked_ = MakeFunctionRows(first_.back(), std::max(columns_, 1));
  for (size_t k = 0; k < functions.size(); ++k) {
    for (int t = 0; t < functions[k].rows(); ++t) {
      Eigen::Map<Eigen::RowVectorXf>(stacked_.Row(first_[k] + t), columns_) =
          functions[k].row(t).cast<float>();
    }
  }
}

float ClusterRanking::Score(const float* row, uint16_t cluster) const {
  float energy = 0;
  for (int f = first_[cluster]; f < first_[cluster + 1]; ++f) {
    const float dot = ConstRow(row, columns_).dot(ConstRow(stacked_.Row(f), columns_));
    energy += dot * dot;
  }
  return energy;
}

void ClusterRanking::ScoreAll(RowsView rows, int64_t begin, int64_t end,
                              std::vector<float>& scores) const {
  const auto clusters = static_cast<int64_t>(first_.size()) - 1;
  const ConstMatrix block(rows.Row(begin), end - begin, columns_,
                          Eigen::OuterStride<>(rows.stride));
  const ConstMatrix stacked(stacked_.values.data(), stacked_.rows, columns_,
                            Eigen::OuterStride<>(stacked_.stride));
  Matrix scaled = block;
  for (int64_t r = 0; r < scaled.rows(); ++r)
    scaled.row(r) *= UnitScale(block.row(r).data(), columns_);
  const Matrix dots = scaled * stacked.transpose();
  scores.assign(static_cast<size_t>((end - begin) * clusters), 0);
  for (int64_t r = 0; r < dots.rows(); ++r) {
    for (int64_t k = 0; k < clusters; ++k) {
      for (int f = first_[k]; f < first_[k + 1]; ++f) {
        scores[r * clusters + k] += dots(r, f) * dots(r, f);
      }
    }
  }
}

ClusterChoices ClusterRanking::Rank(
    RowsView rows, int per_row, const std::vector<uint16_t>& keep,
    const std::function<std::span<const uint16_t>(int64_t)>& allowed) const {
  const auto clusters = static_cast<int64_t>(first_.size()) - 1;
  ClusterChoices choices;
  choices.per_row = per_row;
  choices.cluster.assign(static_cast<size_t>(rows.rows * per_row), kNoCluster);
  ParallelChunks(rows.rows, kChunk, [&](int64_t begin, int64_t end, int64_t) {
    std::vector<float> scores;
    if (!allowed) ScoreAll(rows, begin, end, scores);
    std::vector<Scored> scored;
    std::vector<float> scaled(static_cast<size_t>(columns_));
    for (int64_t r = begin; r < end; ++r) {
      scored.clear();
      const auto add = [&](int64_t k, float energy) {
        if (first_[k] < first_[k + 1]) scored.push_back({energy, static_cast<uint16_t>(k)});
      };
      if (!allowed) {
        for (int64_t k = 0; k < clusters; ++k) add(k, scores[(r - begin) * clusters + k]);
      } else {
        const std::span<const uint16_t> some = allowed(r);
        const bool all_fit = static_cast<int>(some.size()) <= per_row;
        const float scale = all_fit ? 0 : UnitScale(rows.Row(r), columns_);
        for (int j = 0; j < columns_ && !all_fit; ++j) scaled[j] = scale * rows.Row(r)[j];
        for (uint16_t k : some) add(k, all_fit ? 0 : Score(scaled.data(), k));
      }
      FillChoices(scored, keep.empty() ? kNoCluster : keep[r],
                  {choices.cluster.data() + r * per_row, static_cast<size_t>(per_row)});
    }
  });
  return choices;
}

void SolveChoices(RowsView rows, const std::vector<FunctionRows>& bases, const L1Options& l1,
                  ClusterChoices& choices) {
  choices.terms = 0;
  for (const FunctionRows& basis : bases) {
    choices.terms = std::max(choices.terms, static_cast<int>(basis.rows));
  }
  choices.error.assign(choices.cluster.size(), std::numeric_limits<float>::infinity());
  choices.weights.assign(choices.cluster.size() * choices.terms, 0);
  std::vector<std::vector<int64_t>> places(bases.size());
  for (size_t i = 0; i < choices.cluster.size(); ++i) {
    if (choices.cluster[i] != kNoCluster) {
      places[choices.cluster[i]].push_back(static_cast<int64_t>(i));
    }
  }
  ParallelFor(0, static_cast<int64_t>(bases.size()), [&](int64_t k) {
    if (places[k].empty()) return;
    std::vector<int64_t> which(places[k].size());
    std::transform(places[k].begin(), places[k].end(), which.begin(),
                   [&](int64_t place) { return place / choices.per_row; });
    const FunctionRows targets = GatherRows(rows, which);
    const L1Solution solution = SolveL1(bases[k].View(), targets.View(), l1);
    const int64_t terms = bases[k].rows;
    for (int64_t i = 0; i < targets.rows; ++i) {
      choices.error[places[k][i]] = static_cast<float>(solution.errors[i]);
      std::copy_n(solution.weights.begin() + i * terms, terms,
                  choices.weights.begin() + places[k][i] * choices.terms);
    }
  });
}

}  // namespace lfm
