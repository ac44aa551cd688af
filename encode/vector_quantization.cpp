// SPDX-License-Identifier: BSD-3-Clause
// Chen 2002, Section 5 ("Compression of light field maps"): generalised Lloyd from one of two
// starts. Distances to all codes are one matrix product with the factorisation's kernels.
#include "encode/vector_quantization.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <optional>

#include "core/error.h"
#include "encode/codebook_iteration.h"
#include "encode/pairwise_merging.h"

namespace lfm {
namespace {

constexpr int kGrowIterations = 3;  // between doublings: the end has its own
constexpr int kBisections = 5;

void CheckVectors(const WeightedVectors& vectors) {
  const auto require = [](bool condition, const char* problem) {
    if (!condition) throw Error(std::string("vector quantisation: ") + problem);
  };
  require(vectors.segments >= 1 && vectors.dimensions >= vectors.segments &&
              vectors.dimensions % vectors.segments == 0 &&
              vectors.values.size() % vectors.dimensions == 0 &&
              vectors.weights.size() == static_cast<size_t>(vectors.count()) * vectors.segments,
          "values, weights and segments do not fit together");
  require(std::all_of(vectors.values.begin(), vectors.values.end(),
                      [](float value) { return std::isfinite(value); }),
          "a value is not finite");
  require(std::all_of(vectors.weights.begin(), vectors.weights.end(),
                      [](float weight) { return std::isfinite(weight) && weight >= 0; }),
          "a weight is negative or not finite");
}

// The distinct vectors as codes; `cells` says which one each vector is, `count` how many there are.
struct Distinct {
  std::vector<int> cells;
  int count = 0;
};
Distinct FindDistinct(const WeightedVectors& vectors) {
  const size_t bytes = vectors.dimensions * sizeof(float);
  const auto row = [&](int i) {
    return vectors.values.data() + int64_t{1} * i * vectors.dimensions;
  };
  std::vector<int> order(vectors.count());
  std::iota(order.begin(), order.end(), 0);
  const auto compare = [&](int a, int b) { return std::memcmp(row(a), row(b), bytes); };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return compare(a, b) < 0; });
  Distinct distinct{std::vector<int>(order.size()), 0};
  for (size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || compare(order[i - 1], order[i]) != 0) ++distinct.count;
    distinct.cells[order[i]] = distinct.count - 1;
  }
  return distinct;
}

Codebook Lossless(const WeightedVectors& vectors, const Distinct& distinct) {
  Codebook book{distinct.count, {}, distinct.cells, 0};
  book.values.resize(size_t{1} * book.codes * vectors.dimensions);
  for (size_t i = 0; i < distinct.cells.size(); ++i) {
    std::copy_n(vectors.values.data() + i * vectors.dimensions, vectors.dimensions,
                book.values.data() + size_t{1} * distinct.cells[i] * vectors.dimensions);
  }
  return book;
}

// Either start, asked for several sizes.
class Start {
 public:
  Start(const CodebookIteration& iteration, CodebookStart kind) : iteration_(iteration) {
    if (kind == CodebookStart::kPairwise) {
      merging_.emplace(iteration);
    } else {
      largest_ = iteration.OneCode();
    }
  }
  Codebook Cells(int codes) {
    if (merging_) return merging_->Cells(codes);
    // Grown from what there is, or anew.
    if (codes < largest_.codes) largest_ = iteration_.OneCode();
    Codebook book = largest_;
    while (book.codes < codes) {
      const int before = book.codes;
      book = iteration_.Split(std::move(book), std::min(codes, 2 * before));
      if (book.codes == before) break;
      if (book.codes < codes) {
        book = iteration_.Improve(std::move(book), kGrowIterations, 0);
        largest_ = book;
      }
    }
    return book;
  }

 private:
  const CodebookIteration& iteration_;
  std::optional<PairwiseMerging> merging_;
  Codebook largest_;
};

}  // namespace

Codebook QuantizeVectors(const WeightedVectors& vectors, int codes,
                         const CodebookOptions& options) {
  CheckVectors(vectors);
  if (codes < 1) throw Error("vector quantisation: at least one code is needed");
  const Distinct distinct = FindDistinct(vectors);
  if (distinct.count <= codes) return Lossless(vectors, distinct);
  const CodebookIteration iteration(vectors);
  Start start(iteration, options.start);
  return iteration.Improve(start.Cells(codes), options.max_iterations, options.tolerance);
}

Codebook ImproveCodebook(const WeightedVectors& vectors, const Codebook& cells,
                         const CodebookOptions& options) {
  CheckVectors(vectors);
  const CodebookIteration iteration(vectors);
  return iteration.Improve(iteration.FromCells(cells.indices, cells.codes), options.max_iterations,
                           options.tolerance);
}

Codebook QuantizeToDistortion(const WeightedVectors& vectors, double max_distortion,
                              const CodebookOptions& options) {
  CheckVectors(vectors);
  const Distinct distinct = FindDistinct(vectors);
  if (!(max_distortion > 0) || distinct.count <= 1) return Lossless(vectors, distinct);
  const CodebookIteration iteration(vectors);
  Start start(iteration, options.start);
  const auto attempt = [&](int codes) {
    return iteration.Improve(start.Cells(codes), options.max_iterations, options.tolerance);
  };
  int too_few = 0, enough = 1;
  std::optional<Codebook> best;
  for (; enough < distinct.count; enough *= 2) {
    Codebook book = attempt(enough);
    if (book.distortion <= max_distortion) {
      best = std::move(book);
      break;
    }
    too_few = enough;
  }
  if (!best) {
    enough = distinct.count;
    best = Lossless(vectors, distinct);
  }
  for (int i = 0; i < kBisections && enough - too_few > 1; ++i) {
    const int middle = (too_few + enough) / 2;
    Codebook book = attempt(middle);
    const bool fits = book.distortion <= max_distortion;
    (fits ? enough : too_few) = middle;
    if (fits) best = std::move(book);
  }
  return *std::move(best);
}

std::vector<RatePoint> MeasureRates(const WeightedVectors& vectors) {
  CheckVectors(vectors);
  const Distinct distinct = FindDistinct(vectors);
  std::vector<RatePoint> rates;
  if (distinct.count == 0) return rates;
  const CodebookIteration iteration(vectors);
  Codebook book = iteration.OneCode();
  while (book.codes < distinct.count && book.distortion > 0) {
    if (rates.empty() || book.distortion < rates.back().distortion) {
      rates.push_back({book.codes, book.distortion});
    }
    const int before = book.codes;
    book = iteration.Split(std::move(book), std::min(distinct.count, 2 * before));
    if (book.codes == before) break;
    book = iteration.Improve(std::move(book), kGrowIterations, 0);
  }
  rates.push_back({std::max(distinct.count, rates.empty() ? 1 : rates.back().codes + 1), 0.0});
  return rates;
}

}  // namespace lfm
