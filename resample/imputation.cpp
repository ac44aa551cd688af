// SPDX-License-Identifier: BSD-3-Clause
#include "resample/imputation.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace lfm {
namespace {

using Eigen::Index;

// Of the largest singular value: small against what is known of most rows and views, large against
// noise where little is.
constexpr float kRidge_rel = 1e-3F;
// Of the views' factor: where a turn changes less, further ones bring little (docs/figures.md, Time
// of resampling).
constexpr float kSettled_rel = 3e-3F;

/// Means of what is known of each row, and how much is known of each row and view.
struct Means {
  Eigen::VectorXf of_row;  ///< 0 where nothing is known
  Eigen::VectorXf row_count, view_count;
};

Means MeansOfKnown(const PartialMatrix& matrix) {
  const Index rows = matrix.values.rows(), views = matrix.values.cols();
  Means means{Eigen::VectorXf::Zero(rows), Eigen::VectorXf::Zero(rows),
              Eigen::VectorXf::Zero(views)};
  for (Index v = 0; v < views; ++v) {
    for (Index r = 0; r < rows; ++r) {
      if (matrix.knowledge(r, v) == Knowledge::kMissing) continue;
      means.of_row[r] += matrix.values(r, v);
      means.row_count[r] += 1;
      means.view_count[v] += 1;
    }
  }
  means.of_row.array() /= means.row_count.array().max(1);
  return means;
}

/// The matrix with its gaps filled by the row's mean, for a start.
Eigen::MatrixXf FillGaps(const PartialMatrix& matrix, const Means& means) {
  Eigen::MatrixXf filled = matrix.values;
  for (Index v = 0; v < filled.cols(); ++v) {
    for (Index r = 0; r < filled.rows(); ++r) {
      if (matrix.knowledge(r, v) == Knowledge::kMissing) filled(r, v) = means.of_row[r];
    }
  }
  return filled;
}

/// Entries sorted for alternating fits. Normal equations depend on what is known alone: rows of
/// which the same entries are data share theirs.
struct Entries {
  Eigen::MatrixXf data;        ///< rows x views; 0 where an entry takes no part
  Eigen::MatrixXf takes_part;  ///< groups x views; 1, or 0
  std::vector<Index> group_of_row;
  struct Bound {
    Index row, view;
    float value;
  };
  std::vector<Bound> bounds;  ///< their rows have groups of their own
};

Entries SortEntries(const PartialMatrix& matrix) {
  constexpr Index kBits = 64;
  const Index rows = matrix.values.rows(), views = matrix.values.cols();
  Entries entries{Eigen::MatrixXf::Zero(rows, views), {}, {}, {}};
  // Of each row: a bit a view of which something is known, and last which row's bounds those are.
  const auto words = static_cast<size_t>((views + kBits - 1) / kBits);
  std::vector<std::vector<uint64_t>> known(static_cast<size_t>(rows),
                                           std::vector<uint64_t>(words + 1, 0));
  for (Index v = 0; v < views; ++v) {
    for (Index r = 0; r < rows; ++r) {
      const Knowledge knowledge = matrix.knowledge(r, v);
      if (knowledge == Knowledge::kMissing) continue;
      entries.data(r, v) = matrix.values(r, v);
      std::vector<uint64_t>& of_row = known[static_cast<size_t>(r)];
      of_row[static_cast<size_t>(v / kBits)] |= uint64_t{1} << (v % kBits);
      if (knowledge != Knowledge::kLowerBound) continue;
      entries.bounds.push_back({r, v, matrix.values(r, v)});
      of_row[words] = static_cast<uint64_t>(r) + 1;
    }
  }
  std::map<std::vector<uint64_t>, Index> groups;
  std::vector<Index> first_rows;
  for (Index r = 0; r < rows; ++r) {
    const auto next = static_cast<Index>(first_rows.size());
    const auto [at, is_new] = groups.emplace(known[static_cast<size_t>(r)], next);
    if (is_new) first_rows.push_back(r);
    entries.group_of_row.push_back(at->second);
  }
  entries.takes_part.resize(static_cast<Index>(first_rows.size()), views);
  for (size_t g = 0; g < first_rows.size(); ++g) {
    entries.takes_part.row(static_cast<Index>(g)) =
        (matrix.knowledge.row(first_rows[g]).array() != Knowledge::kMissing).cast<float>();
  }
  return entries;
}

/// Bounds count as found: data from now on.
void SettleBounds(const Eigen::MatrixXf& found, Entries& entries) {
  for (const Entries::Bound& bound : entries.bounds) {
    entries.data(bound.row, bound.view) = found(bound.row, bound.view);
    entries.takes_part(entries.group_of_row[static_cast<size_t>(bound.row)], bound.view) = 1;
  }
  entries.bounds.clear();
}

// Products of matrices of any size, compiled once.
Eigen::MatrixXf Times(const Eigen::MatrixXf& a, const Eigen::MatrixXf& b) { return a * b; }
Eigen::MatrixXf TransposedTimes(const Eigen::MatrixXf& a, const Eigen::MatrixXf& b) {
  return a.transpose() * b;
}

/// Modified Gram and Schmidt, twice over; a column that depends on earlier ones becomes zero.
void Orthonormalize(Eigen::MatrixXf& basis) {
  constexpr float kDependent_rel = 1e-5F;
  for (Index k = 0; k < basis.cols(); ++k) {
    auto column = basis.col(k);
    const float before = column.norm();
    for (int pass = 0; pass < 2; ++pass) {
      for (Index j = 0; j < k; ++j) column -= basis.col(j).dot(column) * basis.col(j);
    }
    const float left = column.norm();
    if (left > kDependent_rel * before) {
      column /= left;
    } else {
      column.setZero();
    }
  }
}

/// Leading eigenpairs of a Gram matrix, descending; zero beyond its size.
struct LeadingPairs {
  Eigen::VectorXf values;
  Eigen::MatrixXf vectors;
};

/// By subspace iteration: where a fit starts they need not be exact.
LeadingPairs FindLeadingPairs(Eigen::MatrixXf gram, Index count) {
  constexpr Index kBesides = 3;
  constexpr int kIterations = 6;
  const Index size = gram.rows(), width = std::min(count + kBesides, size);
  LeadingPairs pairs{Eigen::VectorXf::Zero(count), Eigen::MatrixXf::Zero(size, count)};
  const float trace = gram.trace();
  if (!(trace > 0)) return pairs;
  gram /= trace;
  Eigen::MatrixXf basis = Eigen::MatrixXf::Identity(size, size), small = gram;
  if (size > 2 * width) {
    basis.resize(size, width);
    // Columns as far from each other as may be; the first, to which all add, is never without any.
    for (Index k = 0; k < width; ++k) basis.col(k) = gram.col(k * size / width);
    basis.col(0) = gram.rowwise().sum();
    for (int i = 0; i <= kIterations; ++i) {
      Orthonormalize(basis);
      if (i < kIterations) basis = Times(gram, basis);
    }
    small = TransposedTimes(basis, Times(gram, basis));
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXf> solver(small);
  const Index found = std::min(count, small.rows());
  pairs.values.head(found) = trace * solver.eigenvalues().tail(found).reverse();
  pairs.vectors.leftCols(found) =
      Times(basis, solver.eigenvectors().rightCols(found).rowwise().reverse());
  return pairs;
}

/// A fit of K terms by alternating ridge regression: rows . views^T.
template <int K>
class LowRankFit {
 public:
  using Factor = Eigen::Matrix<float, Eigen::Dynamic, K>;

  /// Starts from the principal terms of the filled matrix, the singular value shared evenly by both
  /// sides: then one ridge holds a weak term back more than a strong one.
  explicit LowRankFit(const Eigen::MatrixXf& filled) {
    // What single precision loses of weak terms, the ridge holds back anyway.
    Eigen::MatrixXf gram = Eigen::MatrixXf::Zero(filled.cols(), filled.cols());
    gram.selfadjointView<Eigen::Lower>().rankUpdate(filled.transpose());
    gram = gram.selfadjointView<Eigen::Lower>();
    const LeadingPairs leading = FindLeadingPairs(gram, K);
    rows_.setZero(filled.rows(), K);
    views_.setZero(filled.cols(), K);
    for (int k = 0; k < K; ++k) {
      const float singular = std::sqrt(std::max(0.0F, leading.values[k]));
      if (!(singular > 0)) break;
      const Eigen::VectorXf direction = leading.vectors.col(k);
      const float root = std::sqrt(singular);
      views_.col(k) = direction * root;
      rows_.col(k) = Times(filled, direction) / root;
      if (k == 0) ridge_ = kRidge_rel * singular;
    }
  }

  /// At most `sweeps` turns of both sides, until one changes next to nothing (kSettled_rel).
  /// Without a ridge the data are zero, and so are the terms.
  void Descend(Entries& entries, int sweeps) {
    if (!(ridge_ > 0)) return;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      ChooseBounds(entries);
      FitRows(entries);
      ChooseBounds(entries);
      const Factor before = views_;
      FitViews(entries);
      const float change = (views_ - before).squaredNorm();
      if (change <= kSettled_rel * kSettled_rel * views_.squaredNorm()) return;
    }
  }

  float At(Index row, Index view) const { return rows_.row(row).dot(views_.row(view)); }

 private:
  using Terms = Eigen::Matrix<float, K, 1>;
  using Gram = Eigen::Matrix<float, K, K>;
  /// Gram matrices one beside the other, the columns of each strung together.
  using Grams = Eigen::Matrix<float, Eigen::Dynamic, K * K>;

  static void AddProduct(const Factor& factor, Index from, Grams& grams, Index to) {
    for (int a = 0; a < K; ++a) {
      for (int b = 0; b < K; ++b) grams(to, K * a + b) += factor(from, a) * factor(from, b);
    }
  }

  Eigen::LLT<Gram> Decompose(const Grams& grams, Index at) const {
    Gram gram;
    for (int a = 0; a < K; ++a) {
      for (int b = 0; b < K; ++b) gram(a, b) = grams(at, K * a + b);
    }
    gram.diagonal().array() += ridge_;
    return gram.llt();
  }

  /// A bound takes part while the fit lies below it.
  void ChooseBounds(Entries& entries) const {
    for (const Entries::Bound& bound : entries.bounds) {
      const bool active = At(bound.row, bound.view) < bound.value;
      entries.data(bound.row, bound.view) = active ? bound.value : 0;
      entries.takes_part(entries.group_of_row[static_cast<size_t>(bound.row)], bound.view) =
          active ? 1 : 0;
    }
  }

  void FitRows(const Entries& entries) {
    Grams products = Grams::Zero(views_.rows(), K * K);
    for (Index v = 0; v < views_.rows(); ++v) AddProduct(views_, v, products, v);
    const Grams grams = Times(entries.takes_part, products);
    const Factor right = Times(entries.data, views_);
    std::vector<Eigen::LLT<Gram>> of_groups;
    for (Index g = 0; g < grams.rows(); ++g) of_groups.push_back(Decompose(grams, g));
    for (Index r = 0; r < rows_.rows(); ++r) {
      const Index group = entries.group_of_row[static_cast<size_t>(r)];
      rows_.row(r) = of_groups[static_cast<size_t>(group)].solve(right.row(r).transpose());
    }
  }

  void FitViews(const Entries& entries) {
    Grams products = Grams::Zero(entries.takes_part.rows(), K * K);
    for (Index r = 0; r < rows_.rows(); ++r) {
      AddProduct(rows_, r, products, entries.group_of_row[static_cast<size_t>(r)]);
    }
    const Grams grams = TransposedTimes(entries.takes_part, products);
    const Factor right = TransposedTimes(entries.data, rows_);
    // A view that tells little looks like the mean of all, not like a darker one.
    const Terms expected = ridge_ * views_.colwise().mean().transpose();
    for (Index v = 0; v < views_.rows(); ++v) {
      const Terms sum = right.row(v).transpose() + expected;
      views_.row(v) = Decompose(grams, v).solve(sum);
    }
  }

  Factor rows_, views_;
  float ridge_ = 0;
};

/// The matrix with what a fit of K terms, started from `start`, which has no gaps, says where there
/// are no data.
template <int K>
Eigen::MatrixXf FillFromFit(const PartialMatrix& matrix, const Means& means, Entries& entries,
                            const Eigen::MatrixXf& start, int sweeps, float ceiling) {
  LowRankFit<K> fit(start);
  fit.Descend(entries, sweeps);
  Eigen::MatrixXf result = matrix.values;
  for (Index v = 0; v < result.cols(); ++v) {
    for (Index r = 0; r < result.rows(); ++r) {
      const Knowledge known = matrix.knowledge(r, v);
      if (known == Knowledge::kData) continue;
      float estimate = fit.At(r, v);
      if (known == Knowledge::kLowerBound) {
        estimate = std::max(estimate, matrix.values(r, v));
      } else if (means.row_count[r] == 0 || means.view_count[v] == 0) {
        estimate = means.of_row[r];
      }
      result(r, v) = std::clamp(estimate, 0.0F, ceiling);
    }
  }
  return result;
}

}  // namespace

Eigen::MatrixXf Impute(const PartialMatrix& matrix, float ceiling, int max_terms) {
  constexpr int kSweeps = 20, kMoreSweeps = 10;
  constexpr Index kTermsOfBounds = 2, kViewsForATerm = 3;
  if ((matrix.knowledge.array() == Knowledge::kData).all()) return matrix.values;
  const Means means = MeansOfKnown(matrix);
  const Index most = std::clamp<Index>(matrix.values.cols() / kViewsForATerm, 1,
                                       std::clamp(max_terms, 1, kMaxImputationTerms));
  const Index first = std::min(most, kTermsOfBounds);
  Entries entries = SortEntries(matrix);
  const auto fill = first == 1 ? FillFromFit<1> : FillFromFit<2>;
  Eigen::MatrixXf filled = fill(matrix, means, entries, FillGaps(matrix, means), kSweeps, ceiling);
  const bool gaps = (matrix.knowledge.array() == Knowledge::kMissing).any();
  if (most == first || !gaps) return filled;
  // More terms would be free to shoot up over bounds.
  PartialMatrix rest{filled, matrix.knowledge};
  for (const Entries::Bound& bound : entries.bounds) {
    rest.knowledge(bound.row, bound.view) = Knowledge::kData;
  }
  SettleBounds(filled, entries);
  const auto fill_more = most == 3 ? FillFromFit<3> : FillFromFit<kMaxImputationTerms>;
  return fill_more(rest, means, entries, filled, kMoreSweeps, ceiling);
}

}  // namespace lfm
