// SPDX-License-Identifier: BSD-3-Clause
#include "encode/pairwise_merging.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "encode/pca.h"
#include "encode/product_kernels.h"

namespace lfm {
namespace {

constexpr int kMostCells = 4096;
constexpr int kComponents = 16;  // the most that ComputePca gives

// Cells in the order of their first numbers; one that is merged away has no weight and no place.
struct MergingCells {
  int count = 0, segments = 1, width = 0;  // width: features of a segment
  std::vector<float> features;             // count x segments x width
  std::vector<double> weights;             // count x segments
  std::vector<char> alive;

  double Cost(int a, int b) const {
    double cost = 0;
    for (int s = 0; s < segments; ++s) {
      const double wa = weights[a * segments + s], wb = weights[b * segments + s];
      if (!(wa + wb > 0)) continue;
      const float* x = features.data() + (size_t{1} * a * segments + s) * width;
      const float* y = features.data() + (size_t{1} * b * segments + s) * width;
      float sum = 0;
      for (int k = 0; k < width; ++k) sum += (x[k] - y[k]) * (x[k] - y[k]);
      cost += wa * wb / (wa + wb) * sum;
    }
    return cost;
  }
  void Merge(int a, int b) {
    for (int s = 0; s < segments; ++s) {
      double& wa = weights[a * segments + s];
      const double wb = weights[b * segments + s], sum = wa + wb;
      const auto share = static_cast<float>(sum > 0 ? wb / sum : 0.5);
      float* x = features.data() + (size_t{1} * a * segments + s) * width;
      const float* y = features.data() + (size_t{1} * b * segments + s) * width;
      for (int k = 0; k < width; ++k) x[k] += share * (y[k] - x[k]);
      wa = sum;
    }
    alive[b] = 0;
  }
};

// The leading principal components of rows (count x length), mean taken out.
std::vector<float> Components(std::vector<float> rows, int count, int length) {
  std::vector<double> mean(length, 0.0);
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < length; ++k) mean[k] += rows[size_t{1} * i * length + k];
  }
  float max_abs = 0;
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < length; ++k) {
      float& value = rows[size_t{1} * i * length + k];
      value -= static_cast<float>(mean[k] / count);
      max_abs = std::max(max_abs, std::abs(value));
    }
  }
  const LinearMap map{count, length, max_abs,
                      [&](const float* x, int width, float* y) {
                        kernels::Multiply(rows.data(), count, length, x, width, y);
                      },
                      [&](const float* y, int width, float* x) {
                        kernels::MultiplyTransposed(rows.data(), count, length, y, width, x);
                      }};
  const PcaResult pca =
      ComputePca(map, {.terms = std::min({kComponents, count, length}), .tolerance = 1e-3});
  std::vector<float> features(size_t{1} * count * kComponents, 0.f);
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < pca.terms; ++k) {
      features[size_t{1} * i * kComponents + k] =
          pca.left[size_t{1} * i * pca.width + k] * static_cast<float>(pca.singular_values[k]);
    }
  }
  return features;
}

MergingCells MakeCells(const WeightedVectors& vectors, const Codebook& book) {
  const int d = vectors.dimensions, s = vectors.segments, length = d / s;
  MergingCells cells{book.codes,
                     s,
                     kComponents,
                     {},
                     std::vector<double>(size_t{1} * book.codes * s, 0.0),
                     std::vector<char>(book.codes, 1)};
  cells.features.resize(size_t{1} * book.codes * s * kComponents);
  for (size_t i = 0; i < book.indices.size(); ++i) {
    for (int k = 0; k < s; ++k) {
      cells.weights[size_t{1} * book.indices[i] * s + k] += vectors.weights[i * s + k];
    }
  }
  for (int segment = 0; segment < s; ++segment) {
    std::vector<float> rows(size_t{1} * book.codes * length);
    for (int c = 0; c < book.codes; ++c) {
      std::copy_n(book.values.data() + size_t{1} * c * d + segment * length, length,
                  rows.data() + size_t{1} * c * length);
    }
    const std::vector<float> features = Components(std::move(rows), book.codes, length);
    for (int c = 0; c < book.codes; ++c) {
      std::copy_n(features.data() + size_t{1} * c * kComponents, kComponents,
                  cells.features.data() + (size_t{1} * c * s + segment) * kComponents);
    }
  }
  return cells;
}

struct Neighbor {
  int cell = -1;
  double cost = HUGE_VAL;
};

Neighbor Nearest(const MergingCells& cells, int cell) {
  Neighbor nearest;
  for (int other = 0; other < cells.count; ++other) {
    if (!cells.alive[other] || other == cell) continue;
    const double cost = cells.Cost(cell, other);
    if (cost < nearest.cost) nearest = {other, cost};
  }
  return nearest;
}

}  // namespace

PairwiseMerging::PairwiseMerging(const CodebookIteration& iteration) : iteration_(iteration) {
  const auto count = iteration.vectors().count();
  Codebook book;
  if (count <= kMostCells) {
    std::vector<int> own(count);
    std::iota(own.begin(), own.end(), 0);
    book = {static_cast<int>(count), iteration.vectors().values, std::move(own), 0};
  } else {
    book = iteration.Split(iteration.OneCode(), kMostCells);
  }
  first_cells_ = book.indices;
  first_count_ = book.codes;
  MergingCells cells = MakeCells(iteration.vectors(), book);
  std::vector<Neighbor> nearest(cells.count);
  ParallelFor(
      0, cells.count, [&](int64_t c) { nearest[c] = Nearest(cells, static_cast<int>(c)); }, 16);
  // A union is no nearer to others than its nearer part was: a neighbour is looked for anew only
  // when its cell comes first with one that has changed.
  std::vector<int> version(cells.count, 0), seen(cells.count, 0);
  while (static_cast<int>(merges_.size()) + 1 < cells.count) {
    int first = -1;
    for (int c = 0; c < cells.count; ++c) {
      if (cells.alive[c] && (first < 0 || nearest[c].cost < nearest[first].cost)) first = c;
    }
    const int other = nearest[first].cell;
    if (!cells.alive[other] || seen[first] != version[other]) {
      nearest[first] = Nearest(cells, first);
      seen[first] = version[nearest[first].cell];
      continue;
    }
    cells.Merge(first, other);
    merges_.push_back({first, other});
    ++version[first];
    if (static_cast<int>(merges_.size()) + 1 == cells.count) break;
    nearest[first] = Nearest(cells, first);
    seen[first] = version[nearest[first].cell];
  }
}

Codebook PairwiseMerging::Cells(int codes) const {
  const int merged = std::max(0, first_count_ - codes);
  std::vector<int> into(first_count_);
  std::iota(into.begin(), into.end(), 0);
  // Backwards: where a cell went is known before those that went into it earlier are asked.
  for (int m = merged - 1; m >= 0; --m) into[merges_[m].gone] = into[merges_[m].kept];
  std::vector<int> number(first_count_, -1), indices;
  int used = 0;
  for (const int cell : first_cells_) {
    int& own = number[into[cell]];
    if (own < 0) own = used++;
    indices.push_back(own);
  }
  return iteration_.FromCells(std::move(indices), used);
}

}  // namespace lfm
