// SPDX-License-Identifier: BSD-3-Clause
#include "fields/adaptive_clusters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/parallel.h"
#include "planted_rows.h"

namespace lfm {
namespace {

constexpr double kBias = 4;  // rows of a cluster resemble each other

AdaptiveClusters Divided(const FunctionRows& rows, const AdaptiveOptions& options) {
  return DivideClusters(rows.View(), rows.View(), options);
}

// What the nodes say is what the matrix measures, and d decides.
void ExpectConsistent(const FunctionRows& rows, const AdaptiveClusters& result,
                      const AdaptiveOptions& options) {
  std::vector<PatchSize> leaves;
  for (size_t i = 0; i < result.nodes.size(); ++i) {
    const DivisionNode& node = result.nodes[i];
    if (node.cluster >= 0) {
      EXPECT_LE(node.gain, 0);
      leaves.push_back(node.size);
      continue;
    }
    const PatchSize parts[] = {result.nodes[node.children[0]].size,
                               result.nodes[node.children[1]].size};
    EXPECT_EQ(parts[0].pixels + parts[1].pixels, node.size.pixels);
    EXPECT_GT(node.gain, 0);
    EXPECT_NEAR(node.gain, GainOfDivision(node.size, parts, options.global_terms), 1e-6);
    EXPECT_LT(static_cast<int>(i), node.children[0]);
    EXPECT_EQ(result.nodes[node.children[1]].parent, static_cast<int>(i));
  }
  const std::vector<PatchSize> measured =
      MeasureClusters(rows.View(), result.clustering, {.energy_share = options.energy_share});
  ASSERT_EQ(measured.size(), leaves.size());
  const RenderingCost cost = CostOf(measured, options.global_terms);
  EXPECT_NEAR(result.cost.Total(), cost.Total(), 0.02 * cost.Total());
  EXPECT_EQ(result.cost.pixels, rows.rows);
}

// n = p whatever the patch (linear: mu = 1/2): every division pays, Equation 24, down to where
// integers end it. With N beyond p even the first does not where halves need what the whole needs.
TEST(AdaptiveClusters, DividesTheLinearRegimeDown) {
  const FunctionRows rows = StepRows(64, 64);
  const AdaptiveOptions options = {
      .initial_clusters = 1, .energy_share = 1, .global_terms = 20, .full_rows = 1000};
  const AdaptiveClusters result = Divided(rows, options);
  ExpectConsistent(rows, result, options);
  // p = n = 64: c = 64 (64 + 20). Of single rows: c = 64 (1 + 20).
  EXPECT_EQ(result.nodes[0].size.terms, 64);
  EXPECT_GE(result.clustering.clusters, 32);
  EXPECT_LE(result.cost.Total(), 64 * (2 + 20));
}

// Every patch of two rows and more needs the same three functions (flat: mu = 1): no division pays,
// Equation 25.
TEST(AdaptiveClusters, LeavesTheFlatRegimeWhole) {
  const FunctionRows rows = PlantedRows(1, 80, 3, 50, 1);
  const AdaptiveOptions options = {
      .initial_clusters = 1, .energy_share = 0.999999, .global_terms = 10};
  const AdaptiveClusters result = Divided(rows, options);
  ExpectConsistent(rows, result, options);
  EXPECT_EQ(result.clustering.clusters, 1);
  EXPECT_EQ(result.nodes[0].size.terms, 3);
}

// Planted clusters that share nothing: n is their number times 3 until they are apart, and flat
// below: of one cluster c = 3 (30 + N), of its halves 2 * 3 (15 + N).
TEST(AdaptiveClusters, StopsWhereDSays) {
  const FunctionRows rows = PlantedRows(4, 30, 3, 60, 2, 1, kBias);
  for (const double global : {12.0, 40.0, 100.0}) {
    const AdaptiveOptions options = {
        .initial_clusters = 1, .energy_share = 0.99999, .global_terms = global};
    const AdaptiveClusters result = Divided(rows, options);
    ExpectConsistent(rows, result, options);
    EXPECT_EQ(result.clustering.clusters, 4) << global;
    for (const DivisionNode& node : result.nodes) {
      if (node.cluster >= 0) {
        EXPECT_EQ(node.size.terms, 3);
        EXPECT_EQ(node.size.pixels, 30);
      }
    }
  }
}

// Large clusters are divided by what reduced rows show, small ones by all there is.
TEST(AdaptiveClusters, UsesReducedRowsWhileClustersAreLarge) {
  const FunctionRows rows = PlantedRows(4, 30, 2, 60, 3, 1, kBias);
  FunctionRows blind = MakeFunctionRows(rows.rows, 2);
  for (int64_t row = 0; row < rows.rows; ++row) blind.Row(row)[row % 4 / 2] = 1;
  const AdaptiveOptions options = {
      .initial_clusters = 1, .energy_share = 0.99999, .global_terms = 5, .full_rows = 60};
  const AdaptiveClusters result = DivideClusters(rows.View(), blind.View(), options);
  ExpectConsistent(rows, result, options);
  EXPECT_EQ(result.clustering.clusters, 4);
  // Reduced rows alone tell two groups apart and no more.
  AdaptiveOptions never = options;
  never.full_rows = 0;
  EXPECT_EQ(DivideClusters(rows.View(), blind.View(), never).clustering.clusters, 2);
}

TEST(AdaptiveClusters, HoldsExtremes) {
  const AdaptiveOptions options = {.global_terms = 10};
  EXPECT_EQ(Divided(MakeFunctionRows(0, 5), options).clustering.clusters, 0);
  for (const int rows : {1, 9}) {
    const AdaptiveClusters black = Divided(MakeFunctionRows(rows, 5), options);
    EXPECT_EQ(black.clustering.clusters, 1);
    EXPECT_EQ(black.cost.Total(), 0);
    FunctionRows equal = MakeFunctionRows(rows, 1);
    for (int64_t row = 0; row < rows; ++row) equal.Row(row)[0] = 3;
    EXPECT_EQ(Divided(equal, options).clustering.clusters, 1);
    EXPECT_EQ(Divided(equal, options).cost.Total(), rows + 10);
  }
  for (const double scale : {1e-25, 1e25}) {
    const FunctionRows rows = PlantedRows(3, 20, 2, 30, 4, scale, kBias);
    const AdaptiveOptions planted = {
        .initial_clusters = 1, .energy_share = 0.99999, .global_terms = 4};
    EXPECT_EQ(Divided(rows, planted).clustering.clusters, 3);
  }
}

TEST(AdaptiveClusters, DoesNotDependOnTheNumberOfThreads) {
  const FunctionRows rows = PlantedRows(6, 25, 4, 40, 5);
  const AdaptiveOptions options = {.initial_clusters = 3, .energy_share = 0.99, .global_terms = 8};
  SetThreadCount(1);
  const AdaptiveClusters one = Divided(rows, options);
  SetThreadCount(3);
  const AdaptiveClusters three = Divided(rows, options);
  SetThreadCount(0);
  EXPECT_EQ(one.clustering.cluster, three.clustering.cluster);
  EXPECT_EQ(one.cost.Total(), three.cost.Total());
}

TEST(AdaptiveClusters, RejectsNonsense) {
  FunctionRows rows = PlantedRows(2, 5, 1, 6, 6);
  const FunctionRows fewer = MakeFunctionRows(9, 3);
  EXPECT_THROW(DivideClusters(rows.View(), fewer.View(), {}), Error);
  EXPECT_THROW(Divided(rows, {.initial_clusters = 0}), Error);
  EXPECT_THROW(Divided(rows, {.energy_share = 0}), Error);
  EXPECT_THROW(Divided(rows, {.global_terms = -1}), Error);
  EXPECT_THROW(Divided(rows, {.global_terms = std::numeric_limits<double>::infinity()}), Error);
  rows.Row(2)[2] = NAN;
  EXPECT_THROW(Divided(rows, {}), Error);
}

TEST(AdaptiveClusters, EstimatesNFromSomeRows) {
  const FunctionRows rows = PlantedRows(1, 400, 7, 90, 7);
  EXPECT_EQ(GlobalTerms(rows.View(), 50, 0.999999), 7);
  EXPECT_EQ(GlobalTerms(rows.View(), 1000, 0.999999), 7);
  EXPECT_EQ(GlobalTerms(rows.View(), 1, 0.999999), 1);
  EXPECT_EQ(GlobalTerms(MakeFunctionRows(4, 4).View(), 10, 0.999), 1);
  EXPECT_THROW(GlobalTerms(rows.View(), 0, 0.999), Error);
}

}  // namespace
}  // namespace lfm
