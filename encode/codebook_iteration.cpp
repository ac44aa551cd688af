// SPDX-License-Identifier: BSD-3-Clause
#include "encode/codebook_iteration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "encode/product_kernels.h"

namespace lfm {
namespace {

constexpr int kRowsAtOnce = 64;
constexpr int kCodesAtOnce = 24;  // the widest product of the kernels
constexpr int kAxisRounds = 3;

}  // namespace

std::vector<std::vector<int>> CellMembers(const Codebook& book) {
  std::vector<std::vector<int>> members(book.codes);
  for (size_t i = 0; i < book.indices.size(); ++i) {
    members[book.indices[i]].push_back(static_cast<int>(i));
  }
  return members;
}

// Distances are expanded, w x^2 - 2 w x y + w y^2, so that all of them are one matrix product;
// taking the mean out first keeps what cancels small.
CodebookIteration::CodebookIteration(const WeightedVectors& vectors) : vectors_(vectors) {
  const int d = vectors.dimensions, s = vectors.segments, length = d / s;
  const int64_t count = vectors.count();
  std::vector<double> sum(d, 0.0);
  for (int64_t i = 0; i < count; ++i) {
    for (int k = 0; k < d; ++k) sum[k] += vectors.values[i * d + k];
  }
  for (const double total : sum) {
    mean_.push_back(static_cast<float>(total / static_cast<double>(std::max<int64_t>(1, count))));
  }
  scaled_.resize(count * (d + s));
  ParallelFor(
      0, count,
      [&](int64_t i) {
        float* row = scaled_.data() + i * (d + s);
        const float* weights = vectors.weights.data() + i * s;
        for (int k = 0; k < d; ++k) {
          row[k] = weights[k / length] * (vectors.values[i * d + k] - mean_[k]);
        }
        std::copy_n(weights, s, row + d);
      },
      256);
}

double CodebookIteration::Distance(int64_t vector, const float* code) const {
  const int length = vectors_.dimensions / vectors_.segments;
  const float* x = vectors_.values.data() + vector * vectors_.dimensions;
  double distance = 0;
  for (int s = 0; s < vectors_.segments; ++s) {
    double sum = 0;
    for (int k = s * length; k < (s + 1) * length; ++k) {
      const double difference = static_cast<double>(x[k]) - code[k];
      sum += difference * difference;
    }
    distance += vectors_.weights[vector * vectors_.segments + s] * sum;
  }
  return distance;
}

std::vector<double> CodebookIteration::Distances(const Codebook& book) const {
  std::vector<double> distances(vectors_.count());
  ParallelFor(
      0, vectors_.count(),
      [&](int64_t i) {
        distances[i] =
            Distance(i, book.values.data() + size_t{1} * book.indices[i] * vectors_.dimensions);
      },
      64);
  return distances;
}

void CodebookIteration::Assign(Codebook& book) const {
  const int d = vectors_.dimensions, s = vectors_.segments, length = d / s;
  const int groups = (book.codes + kCodesAtOnce - 1) / kCodesAtOnce;
  // Codes as columns: -2 (y - mean), then |y - mean|^2 of each segment. Columns beyond the last
  // code repeat it.
  std::vector<float> columns(size_t{1} * groups * kCodesAtOnce * (d + s), 0.f);
  ParallelFor(0, int64_t{groups} * kCodesAtOnce, [&](int64_t column) {
    const float* code = book.values.data() + std::min<int64_t>(column, book.codes - 1) * d;
    float* first =
        columns.data() + column / kCodesAtOnce * kCodesAtOnce * (d + s) + column % kCodesAtOnce;
    std::vector<double> squares(s, 0.0);
    for (int k = 0; k < d; ++k) {
      const float value = code[k] - mean_[k];
      first[size_t{1} * k * kCodesAtOnce] = -2 * value;
      squares[k / length] += static_cast<double>(value) * value;
    }
    for (int k = 0; k < s; ++k) {
      first[size_t{1} * (d + k) * kCodesAtOnce] = static_cast<float>(squares[k]);
    }
  });
  ParallelChunks(vectors_.count(), kRowsAtOnce, [&](int64_t begin, int64_t end, int64_t) {
    std::array<float, kRowsAtOnce * kCodesAtOnce> scores;
    std::array<float, kRowsAtOnce> least;
    std::array<int, kRowsAtOnce> best{};
    least.fill(HUGE_VALF);
    for (int group = 0; group < groups; ++group) {
      kernels::Multiply(scaled_.data() + begin * (d + s), static_cast<int>(end - begin), d + s,
                        columns.data() + size_t{1} * group * kCodesAtOnce * (d + s), kCodesAtOnce,
                        scores.data());
      const int codes = std::min(kCodesAtOnce, book.codes - group * kCodesAtOnce);
      for (int64_t row = 0; row < end - begin; ++row) {
        for (int k = 0; k < codes; ++k) {
          if (scores[row * kCodesAtOnce + k] >= least[row]) continue;
          least[row] = scores[row * kCodesAtOnce + k];
          best[row] = group * kCodesAtOnce + k;
        }
      }
    }
    // float32 decides between near ties as it likes; the distortion must not rise by that.
    for (int64_t i = begin; i < end; ++i) {
      const int found = best[i - begin];
      int& index = book.indices[i];
      if (found == index) continue;
      const double before = Distance(i, book.values.data() + size_t{1} * index * d);
      if (Distance(i, book.values.data() + size_t{1} * found * d) < before) index = found;
    }
  });
}

void CodebookIteration::FillEmptyCells(Codebook& book) const {
  std::vector<int> sizes(book.codes, 0);
  for (const int index : book.indices) ++sizes[index];
  if (std::find(sizes.begin(), sizes.end(), 0) == sizes.end()) return;
  const std::vector<double> distances = Distances(book);
  std::vector<int> order(distances.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return distances[a] > distances[b]; });
  size_t next = 0;
  for (int code = 0; code < book.codes; ++code) {
    if (sizes[code] > 0) continue;
    while (next < order.size() && sizes[book.indices[order[next]]] < 2) ++next;
    if (next == order.size()) return;
    --sizes[book.indices[order[next]]];
    book.indices[order[next]] = code;
    sizes[code] = 1;
    ++next;
  }
}

void CodebookIteration::MoveToCentroids(Codebook& book) const {
  const int d = vectors_.dimensions, s = vectors_.segments, length = d / s;
  const std::vector<std::vector<int>> members = CellMembers(book);
  ParallelFor(0, book.codes, [&](int64_t code) {
    float* values = book.values.data() + code * d;
    std::vector<double> sum(length);
    for (int segment = 0; segment < s && !members[code].empty(); ++segment) {
      double total = 0;
      for (const int i : members[code]) total += vectors_.weights[int64_t{1} * i * s + segment];
      sum.assign(length, 0.0);
      for (const int i : members[code]) {
        // What does not count still has a place: the plain mean.
        const double weight = total > 0 ? vectors_.weights[int64_t{1} * i * s + segment] : 1.0;
        const float* x = vectors_.values.data() + int64_t{1} * i * d + segment * length;
        for (int k = 0; k < length; ++k) sum[k] += weight * x[k];
      }
      if (!(total > 0)) total = static_cast<double>(members[code].size());
      for (int k = 0; k < length; ++k) {
        values[segment * length + k] = static_cast<float>(sum[k] / total);
      }
    }
  });
  const std::vector<double> distances = Distances(book);
  book.distortion = std::accumulate(distances.begin(), distances.end(), 0.0);
}

Codebook CodebookIteration::FromCells(std::vector<int> indices, int codes) const {
  Codebook book{codes, std::vector<float>(size_t{1} * codes * vectors_.dimensions),
                std::move(indices), 0};
  MoveToCentroids(book);
  return book;
}

Codebook CodebookIteration::OneCode() const {
  return FromCells(std::vector<int>(vectors_.count(), 0), 1);
}

Codebook CodebookIteration::Improve(Codebook book, int iterations, double tolerance) const {
  for (int i = 0; i < iterations; ++i) {
    const double before = book.distortion;
    Assign(book);
    FillEmptyCells(book);
    MoveToCentroids(book);
    if (!(before - book.distortion > tolerance * before)) break;
  }
  return book;
}

// The direction in which a cell's vectors spread most, of unit length; empty when they do not.
std::vector<double> CodebookIteration::MainAxis(const std::vector<int>& members,
                                                const float* code) const {
  const int d = vectors_.dimensions, s = vectors_.segments, length = d / s;
  int farthest = members.front();
  double most = 0;
  for (const int i : members) {
    const double distance = Distance(i, code);
    if (distance > most) {
      most = distance;
      farthest = i;
    }
  }
  if (!(most > 0)) return {};
  std::vector<double> axis(d), next(d);
  for (int k = 0; k < d; ++k) {
    axis[k] = static_cast<double>(vectors_.values[int64_t{1} * farthest * d + k]) - code[k];
  }
  for (int round = 0; round <= kAxisRounds; ++round) {
    double norm = 0;
    for (const double value : axis) norm += value * value;
    if (!(norm > 0)) return {};
    for (double& value : axis) value /= std::sqrt(norm);
    if (round == kAxisRounds) break;
    next.assign(d, 0.0);
    for (const int i : members) {
      const float* x = vectors_.values.data() + int64_t{1} * i * d;
      const float* weights = vectors_.weights.data() + int64_t{1} * i * s;
      double along = 0;
      for (int k = 0; k < d; ++k) {
        along += weights[k / length] * axis[k] * (static_cast<double>(x[k]) - code[k]);
      }
      for (int k = 0; k < d; ++k) {
        next[k] += weights[k / length] * along * (static_cast<double>(x[k]) - code[k]);
      }
    }
    axis.swap(next);
  }
  return axis;
}

// Members on the far side of the axis' middle go to the new code, the last one.
bool CodebookIteration::SplitCell(Codebook& book, int code, const std::vector<int>& members) const {
  const int d = vectors_.dimensions;
  const float* values = book.values.data() + size_t{1} * code * d;
  const std::vector<double> axis = MainAxis(members, values);
  if (axis.empty()) return false;
  std::vector<int> far;
  for (const int i : members) {
    const float* x = vectors_.values.data() + int64_t{1} * i * d;
    double along = 0;
    for (int k = 0; k < d; ++k) along += axis[k] * (static_cast<double>(x[k]) - values[k]);
    if (along > 0) far.push_back(i);
  }
  if (far.empty() || far.size() == members.size()) return false;
  for (const int i : far) book.indices[i] = book.codes;
  ++book.codes;
  return true;
}

Codebook CodebookIteration::Split(Codebook book, int codes) const {
  while (book.codes < codes) {
    const int before = book.codes;
    const std::vector<double> distances = Distances(book);
    std::vector<double> cell(before, 0.0);
    for (size_t i = 0; i < distances.size(); ++i) cell[book.indices[i]] += distances[i];
    std::vector<int> order(before);
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return cell[a] > cell[b]; });
    const std::vector<std::vector<int>> members = CellMembers(book);
    for (const int code : order) {
      if (book.codes == codes || !(cell[code] > 0)) break;
      SplitCell(book, code, members[code]);
    }
    if (book.codes == before) break;
    book.values.resize(size_t{1} * book.codes * vectors_.dimensions);
    MoveToCentroids(book);
  }
  return book;
}

}  // namespace lfm
