// SPDX-License-Identifier: BSD-3-Clause
#include "fields/clustered_pca.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/matrix_products.h"
#include "planted_rows.h"

namespace lfm {
namespace {

// Whether rows of one planted cluster are together, and no others.
bool AreTheClusters(const Clustering& found, int clusters) {
  std::vector<std::set<int>> numbers(static_cast<size_t>(clusters));
  std::set<int> all;
  for (size_t row = 0; row < found.cluster.size(); ++row) {
    numbers[row % clusters].insert(found.cluster[row]);
    all.insert(found.cluster[row]);
  }
  for (const std::set<int>& number : numbers) {
    if (number.size() != 1) return false;
  }
  return static_cast<int>(all.size()) == clusters && found.clusters == clusters;
}

TEST(ClusteredPca, FindsPlantedClusters) {
  const FunctionRows rows = PlantedRows(5, 40, 2, 60, 1);
  const Clustering found = ClusterRows(rows.View(), {.clusters = 5, .terms = 2, .iterations = 40});
  EXPECT_TRUE(AreTheClusters(found, 5));
  const ClusteredModel model = ModelOfClusters(rows.View(), found, {.energy_share = 0.99999});
  CheckModel(model);
  EXPECT_LT(RelativeError(model, rows.View(), -1), 1e-5);
  for (const PatchSize& size : SizesOf(model)) {
    EXPECT_EQ(size.pixels, 40);
    EXPECT_EQ(size.terms, 2);
  }
}

TEST(ClusteredPca, LeavesLessThanOneClusterDoes) {
  const FunctionRows rows = PlantedRows(6, 30, 4, 50, 2);
  const TermsOptions three = {.max_terms = 3};
  double last = 2;
  for (const int clusters : {1, 3, 6, 12}) {
    const Clustering found = ClusterRows(rows.View(), {.clusters = clusters, .terms = 3});
    EXPECT_EQ(found.clusters, clusters);
    const double error = RelativeError(ModelOfClusters(rows.View(), found, three), rows.View(), -1);
    EXPECT_LT(error, last);
    last = error;
  }
}

TEST(ClusteredPca, MeasuresWhatTheModelHas) {
  const FunctionRows rows = PlantedRows(4, 25, 3, 40, 3);
  const Clustering found = ClusterRows(rows.View(), {.clusters = 3, .terms = 3});
  const TermsOptions terms = {.energy_share = 0.98};
  const std::vector<PatchSize> of_model = SizesOf(ModelOfClusters(rows.View(), found, terms));
  const std::vector<PatchSize> measured = MeasureClusters(rows.View(), found, terms);
  ASSERT_EQ(measured.size(), of_model.size());
  for (size_t c = 0; c < measured.size(); ++c) {
    EXPECT_EQ(measured[c].terms, of_model[c].terms);
    EXPECT_EQ(measured[c].pixels, of_model[c].pixels);
  }
}

// Every cluster holds the share of its own energy, so all together do.
TEST(ClusteredPca, HoldsTheShareOfTheEnergy) {
  const FunctionRows rows = PlantedRows(3, 50, 12, 64, 4);
  const Clustering found = ClusterRows(rows.View(), {.clusters = 4, .terms = 4});
  const ClusteredModel model = ModelOfClusters(rows.View(), found, {.energy_share = 0.97});
  double left = 0;
  std::vector<float> values(64);
  for (int64_t row = 0; row < rows.rows; ++row) {
    EvaluateRow(model, row, -1, values.data());
    for (int j = 0; j < 64; ++j) left += std::pow(double{rows.Row(row)[j]} - values[j], 2);
  }
  EXPECT_LT(left, 0.03 * EnergyOf(rows.View()));
}

TEST(ClusteredPca, DissolvesSmallClusters) {
  const FunctionRows rows = PlantedRows(7, 9, 2, 30, 5);
  for (const int64_t least : {1, 8, 20, 1000}) {
    const Clustering found =
        ClusterRows(rows.View(), {.clusters = 10, .terms = 2, .min_rows = least});
    ASSERT_GE(found.clusters, 1);
    for (const auto& members : found.Members()) {
      EXPECT_GE(members.size(), found.clusters == 1 ? 1 : static_cast<size_t>(least));
    }
  }
}

TEST(ClusteredPca, FillsClustersThatLoseTheirRows) {
  // Two lines and forty clusters: seeds can draw only two, noise on them makes the rest.
  FunctionRows rows = PlantedRows(2, 60, 1, 20, 6);
  for (int64_t row = 0; row < rows.rows; ++row) rows.Row(row)[row % 20] += 0.01f * (1 + row % 7);
  const Clustering found = ClusterRows(rows.View(), {.clusters = 40, .terms = 1});
  EXPECT_GE(found.clusters, 38);
  for (const auto& members : found.Members()) EXPECT_FALSE(members.empty());
}

TEST(ClusteredPca, HoldsExtremes) {
  const FunctionRows none = MakeFunctionRows(0, 5);
  EXPECT_EQ(ClusterRows(none.View(), {}).clusters, 0);
  EXPECT_EQ(ModelOfClusters(none.View(), {}, {}).rows, 0);

  const FunctionRows black = MakeFunctionRows(9, 5);
  const Clustering one = ClusterRows(black.View(), {.clusters = 4});
  EXPECT_EQ(one.clusters, 1);
  EXPECT_EQ(ModelOfClusters(black.View(), one, {}).bases[0].rows, 0);

  FunctionRows equal = MakeFunctionRows(9, 5);
  for (int64_t row = 0; row < 9; ++row) std::fill_n(equal.Row(row), 5, 2.0f);
  const Clustering same = ClusterRows(equal.View(), {.clusters = 4, .terms = 3});
  EXPECT_EQ(same.clusters, 1);
  const ClusteredModel model = ModelOfClusters(equal.View(), same, {.max_terms = 7});
  EXPECT_EQ(model.bases[0].rows, 1);
  EXPECT_LT(RelativeError(model, equal.View(), -1), 1e-12);

  const FunctionRows pixel = PlantedRows(1, 1, 1, 5, 7), column = PlantedRows(1, 8, 1, 1, 8);
  for (const FunctionRows* rows : {&pixel, &column}) {
    const Clustering found = ClusterRows(rows->View(), {.clusters = 6, .terms = 9});
    EXPECT_EQ(found.clusters, 1);
    EXPECT_LT(RelativeError(ModelOfClusters(rows->View(), found, {}), rows->View(), -1), 1e-10);
  }
}

TEST(ClusteredPca, HoldsExtremeMagnitudes) {
  for (const double scale : {1e-25, 1e25}) {
    const FunctionRows rows = PlantedRows(3, 30, 2, 40, 9, scale);
    const Clustering found = ClusterRows(rows.View(), {.clusters = 3, .terms = 2});
    EXPECT_TRUE(AreTheClusters(found, 3));
    EXPECT_LT(RelativeError(ModelOfClusters(rows.View(), found, {.max_terms = 2}), rows.View(), -1),
              1e-9);
  }
}

TEST(ClusteredPca, DoesNotDependOnTheNumberOfThreads) {
  const FunctionRows rows = PlantedRows(8, 40, 5, 70, 10);
  SetThreadCount(1);
  const Clustering one = ClusterRows(rows.View(), {.clusters = 12, .terms = 3});
  const ClusteredModel model = ModelOfClusters(rows.View(), one, {.energy_share = 0.9});
  SetThreadCount(3);
  EXPECT_EQ(ClusterRows(rows.View(), {.clusters = 12, .terms = 3}).cluster, one.cluster);
  EXPECT_EQ(ModelOfClusters(rows.View(), one, {.energy_share = 0.9}).weights, model.weights);
  SetThreadCount(0);
}

TEST(ClusteredPca, RejectsNonsense) {
  FunctionRows rows = PlantedRows(2, 5, 1, 6, 11);
  EXPECT_THROW(ClusterRows(rows.View(), {.clusters = 0}), Error);
  EXPECT_THROW(ClusterRows(rows.View(), {.terms = 0}), Error);
  EXPECT_THROW(ClusterRows(rows.View(), {.min_rows = 0}), Error);
  EXPECT_THROW(ModelOfClusters(rows.View(), {1, {0, 0}}, {}), Error);
  EXPECT_THROW(
      ModelOfClusters(rows.View(), {1, std::vector<int>(10)}, {.centring = Centring::kMean}),
      Error);
  rows.Row(3)[1] = NAN;
  EXPECT_THROW(ClusterRows(rows.View(), {}), Error);
}

}  // namespace
}  // namespace lfm
