// SPDX-License-Identifier: BSD-3-Clause
#include "encode/vector_quantization.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "core/error.h"
#include "core/parallel.h"
#include "encode/codebook_iteration.h"

namespace lfm::testing {
namespace {

constexpr double kTieTolerance_rel = 1e-5;  // float32 scores decide between near ties

// Clusters round `centers` random centres, with weights over three decades.
WeightedVectors MakeClusters(int count, int dimensions, int segments, int centers, float spread,
                             int seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> decade(-1.5f, 1.5f);
  std::vector<float> center(size_t{1} * centers * dimensions);
  for (float& value : center) value = 10 + 3 * normal(random);
  WeightedVectors vectors{dimensions, segments, {}, {}};
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < dimensions; ++k) {
      vectors.values.push_back(center[size_t{1} * (i % centers) * dimensions + k] +
                               spread * normal(random));
    }
    for (int s = 0; s < segments; ++s) vectors.weights.push_back(std::pow(10.f, decade(random)));
  }
  return vectors;
}

double Distance(const WeightedVectors& vectors, int64_t i, const float* code) {
  const int length = vectors.dimensions / vectors.segments;
  double sum = 0;
  for (int k = 0; k < vectors.dimensions; ++k) {
    const double difference = double{vectors.values[i * vectors.dimensions + k]} - code[k];
    sum += vectors.weights[i * vectors.segments + k / length] * difference * difference;
  }
  return sum;
}

double Distortion(const WeightedVectors& vectors, const Codebook& book) {
  double sum = 0;
  for (int64_t i = 0; i < vectors.count(); ++i) {
    sum +=
        Distance(vectors, i, book.values.data() + size_t{1} * book.indices[i] * vectors.dimensions);
  }
  return sum;
}

void ExpectConsistent(const WeightedVectors& vectors, const Codebook& book, int most) {
  EXPECT_LE(book.codes, most);
  ASSERT_EQ(book.values.size(), static_cast<size_t>(book.codes) * vectors.dimensions);
  ASSERT_EQ(static_cast<int64_t>(book.indices.size()), vectors.count());
  std::set<int> used(book.indices.begin(), book.indices.end());
  EXPECT_EQ(static_cast<int>(used.size()), book.codes) << "a code without a vector";
  EXPECT_GE(*used.begin(), 0);
  EXPECT_LT(*used.rbegin(), book.codes);
  EXPECT_NEAR(book.distortion, Distortion(vectors, book), 1e-9 * (1 + book.distortion));
}

constexpr CodebookStart kStarts[] = {CodebookStart::kSplitting, CodebookStart::kPairwise};

// At the fixed point of Lloyd's iteration no vector has a nearer code (found by brute force) and
// each code is the weighted mean of its vectors.
TEST(VectorQuantization, EndsAtAFixedPointOfLloydsIteration) {
  const WeightedVectors vectors = MakeClusters(300, 12, 3, 40, 2.f, 1);
  for (const CodebookStart start : kStarts) {
    const Codebook book =
        QuantizeVectors(vectors, 25, {.start = start, .max_iterations = 500, .tolerance = 0});
    ExpectConsistent(vectors, book, 25);
    EXPECT_EQ(book.codes, 25);
    for (int64_t i = 0; i < vectors.count(); ++i) {
      const double own = Distance(vectors, i, book.values.data() + book.indices[i] * 12);
      for (int c = 0; c < book.codes; ++c) {
        EXPECT_LE(own, Distance(vectors, i, book.values.data() + c * 12) * (1 + kTieTolerance_rel));
      }
    }
    for (int c = 0; c < book.codes; ++c) {
      for (int k = 0; k < 12; ++k) {
        double sum = 0, weight = 0;
        for (int64_t i = 0; i < vectors.count(); ++i) {
          if (book.indices[i] != c) continue;
          sum += double{vectors.weights[i * 3 + k / 4]} * vectors.values[i * 12 + k];
          weight += vectors.weights[i * 3 + k / 4];
        }
        EXPECT_NEAR(book.values[c * 12 + k], sum / weight, 1e-5 * std::abs(sum / weight));
      }
    }
  }
}

TEST(VectorQuantization, DistortionNeverRises) {
  const WeightedVectors vectors = MakeClusters(500, 20, 1, 300, 3.f, 2);
  const CodebookIteration iteration(vectors);
  Codebook book = iteration.Split(iteration.OneCode(), 32);
  ASSERT_EQ(book.codes, 32);
  int lowered = 0;
  for (int i = 0; i < 20; ++i) {
    const double before = book.distortion;
    book = iteration.Improve(std::move(book), 1, 0);
    EXPECT_LE(book.distortion, before * (1 + 1e-12));
    lowered += book.distortion < before;
  }
  EXPECT_GE(lowered, 3);
}

// Well-separated clusters: merging the nearest finds them; splitting ends in a local minimum that
// is far better than no clusters.
TEST(VectorQuantization, FindsClustersThatThereAre) {
  const WeightedVectors vectors = MakeClusters(640, 16, 2, 32, 0.01f, 3);
  const Codebook merged = QuantizeVectors(vectors, 32, {.start = CodebookStart::kPairwise});
  ExpectConsistent(vectors, merged, 32);
  for (int i = 0; i < 640; ++i) EXPECT_EQ(merged.indices[i], merged.indices[i % 32]) << i;
  double all = 0;
  for (const float weight : vectors.weights) all += weight;
  EXPECT_LE(merged.distortion, 2 * 0.01 * 0.01 * 8 * all);
  const Codebook split = QuantizeVectors(vectors, 32, {});
  ExpectConsistent(vectors, split, 32);
  EXPECT_LE(split.distortion, 0.2 * QuantizeVectors(vectors, 1, {}).distortion);
}

// Four points on a line and two codes: the best partition is known.
TEST(VectorQuantization, WeightsDecideWhereCodesGo) {
  WeightedVectors vectors{1, 1, {0, 4, 5, 9}, {1, 1, 1, 1}};
  for (const CodebookStart start : kStarts) {
    vectors.weights = {100, 1, 1, 100};
    Codebook book = QuantizeVectors(vectors, 3, {.start = start});
    EXPECT_EQ(book.indices[1], book.indices[2]);
    EXPECT_NEAR(book.distortion, 0.5, 1e-6);
    vectors.weights = {1, 100, 100, 1};
    book = QuantizeVectors(vectors, 3, {.start = start});
    EXPECT_LE(book.distortion, 50.0);
  }
}

TEST(VectorQuantization, IsLosslessWithAsManyCodesAsDistinctVectors) {
  WeightedVectors vectors = MakeClusters(30, 6, 2, 30, 1.f, 4);
  const std::vector<float> once = vectors.values, weights = vectors.weights;
  vectors.values.insert(vectors.values.end(), once.begin(), once.end());
  vectors.weights.insert(vectors.weights.end(), weights.begin(), weights.end());
  for (const CodebookStart start : kStarts) {
    for (const int codes : {30, 31, 60, 1000}) {
      const Codebook book = QuantizeVectors(vectors, codes, {.start = start});
      ExpectConsistent(vectors, book, 30);
      EXPECT_EQ(book.codes, 30);
      EXPECT_EQ(book.distortion, 0);
      EXPECT_EQ(Distortion(vectors, book), 0);
    }
    const Codebook fewer = QuantizeVectors(vectors, 29, {.start = start});
    ExpectConsistent(vectors, fewer, 29);
    EXPECT_GT(fewer.distortion, 0);
  }
}

TEST(VectorQuantization, Extremes) {
  for (const CodebookStart start : kStarts) {
    EXPECT_EQ(QuantizeVectors({.dimensions = 3}, 5, {.start = start}).codes, 0);
    const WeightedVectors one{2, 1, {1, 2}, {3}};
    EXPECT_EQ(QuantizeVectors(one, 1, {.start = start}).values, one.values);
    const WeightedVectors same{2, 1, {1, 2, 1, 2, 1, 2}, {3, 0, 1}};
    EXPECT_EQ(QuantizeVectors(same, 2, {.start = start}).codes, 1);
    // Nothing counts: any code will do, but finite ones.
    WeightedVectors nothing = MakeClusters(50, 4, 2, 50, 1.f, 5);
    std::fill(nothing.weights.begin(), nothing.weights.end(), 0.f);
    const Codebook book = QuantizeVectors(nothing, 4, {.start = start});
    EXPECT_EQ(book.distortion, 0);
    for (const float value : book.values) EXPECT_TRUE(std::isfinite(value));
    // Far from zero, tiny differences: the mean is taken out first.
    WeightedVectors far = MakeClusters(64, 8, 1, 4, 1e-3f, 6);
    for (float& value : far.values) value += 1000;
    const Codebook found = QuantizeVectors(far, 4, {.start = start});
    for (int i = 0; i < 64; ++i) EXPECT_EQ(found.indices[i], found.indices[i % 4]);
  }
  EXPECT_THROW(QuantizeVectors({3, 1, {1, 2}, {1}}, 1, {}), Error);
  EXPECT_THROW(QuantizeVectors({2, 1, {1, 2}, {1, 1}}, 1, {}), Error);
  EXPECT_THROW(QuantizeVectors({3, 2, {1, 2, 3}, {1, 1}}, 1, {}), Error);
  EXPECT_THROW(QuantizeVectors({2, 1, {1, 2}, {-1}}, 1, {}), Error);
  EXPECT_THROW(QuantizeVectors({2, 1, {1, std::numeric_limits<float>::quiet_NaN()}, {1}}, 1, {}),
               Error);
  EXPECT_THROW(QuantizeVectors({2, 1, {1, 2}, {HUGE_VALF}}, 1, {}), Error);
  EXPECT_THROW(QuantizeVectors({2, 1, {1, 2}, {1}}, 0, {}), Error);
}

TEST(VectorQuantization, EmptyCellsTakeWhatIsCodedWorst) {
  // A start with two equal codes: Lloyd alone would leave one of them empty.
  const WeightedVectors vectors{1, 1, {0, 0.1f, 10, 10.1f, 20}, {1, 1, 1, 1, 1}};
  const CodebookIteration iteration(vectors);
  Codebook book{3, {5, 5, 5}, {0, 0, 0, 0, 0}, 1e9};
  book = iteration.Improve(std::move(book), 10, 0);
  ExpectConsistent(vectors, book, 3);
  EXPECT_NEAR(book.distortion, 0.01, 1e-5);
}

TEST(VectorQuantization, IsDrivenByDistortion) {
  const WeightedVectors vectors = MakeClusters(400, 10, 1, 100, 1.f, 7);
  for (const CodebookStart start : kStarts) {
    const CodebookOptions options{.start = start};
    const double one = QuantizeVectors(vectors, 1, options).distortion;
    int before = 0;
    for (const double share : {1.0, 0.5, 0.2, 0.05}) {
      const Codebook book = QuantizeToDistortion(vectors, share * one, options);
      ExpectConsistent(vectors, book, 400);
      EXPECT_LE(book.distortion, share * one * (1 + 1e-12));
      EXPECT_GT(book.codes, before);
      before = book.codes;
      // Not many more than needed.
      if (book.codes > 4) {
        EXPECT_GT(QuantizeVectors(vectors, book.codes * 4 / 5, options).distortion, share * one);
      }
    }
    EXPECT_EQ(QuantizeToDistortion(vectors, 0, options).codes, 400);
  }
}

TEST(VectorQuantization, RatesFallToNothing) {
  const WeightedVectors vectors = MakeClusters(100, 6, 1, 100, 1.f, 8);
  const std::vector<RatePoint> rates = MeasureRates(vectors);
  ASSERT_GE(rates.size(), 6u);
  EXPECT_EQ(rates.front().codes, 1);
  EXPECT_NEAR(rates.front().distortion, QuantizeVectors(vectors, 1, {}).distortion,
              1e-6 * rates.front().distortion);
  for (size_t i = 1; i < rates.size(); ++i) {
    EXPECT_GT(rates[i].codes, rates[i - 1].codes);
    EXPECT_LT(rates[i].distortion, rates[i - 1].distortion);
  }
  EXPECT_EQ(rates.back().codes, 100);
  EXPECT_EQ(rates.back().distortion, 0);
}

TEST(VectorQuantization, DoesNotDependOnThreads) {
  const WeightedVectors vectors = MakeClusters(700, 24, 3, 650, 2.f, 9);
  for (const CodebookStart start : kStarts) {
    SetThreadCount(1);
    const Codebook one = QuantizeVectors(vectors, 100, {.start = start, .max_iterations = 5});
    SetThreadCount(0);
    const Codebook many = QuantizeVectors(vectors, 100, {.start = start, .max_iterations = 5});
    EXPECT_EQ(one.values, many.values);
    EXPECT_EQ(one.indices, many.indices);
    ExpectConsistent(vectors, many, 100);
  }
}

// More vectors than pairs are looked for among: cells first.
TEST(VectorQuantization, ManyVectorsAreMergedFromCells) {
  const WeightedVectors vectors = MakeClusters(4200, 4, 1, 4200, 2.f, 10);
  const Codebook book =
      QuantizeVectors(vectors, 500, {.start = CodebookStart::kPairwise, .max_iterations = 3});
  ExpectConsistent(vectors, book, 500);
  EXPECT_LE(book.distortion, 0.2 * QuantizeVectors(vectors, 1, {}).distortion);
}

}  // namespace
}  // namespace lfm::testing
