// SPDX-License-Identifier: BSD-3-Clause
#include "fields/sparse_clusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/residual.h"

namespace lfm {
namespace {

constexpr int kColumns = 60;

struct Planted {
  Field field;
  std::vector<int> cluster;  // a row
  double spikes = 0;         // the share of entries that have one
};

// Rows of `clusters` bases of `terms` random functions each, of positive weights, in patches of a
// picture, and spikes.
Planted Plant(int width, int height, int channels, int clusters, int terms, double spikes) {
  std::mt19937 random(17);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<std::vector<std::vector<float>>> bases(clusters);
  for (auto& basis : bases) {
    basis.resize(terms);
    for (auto& function : basis) {
      for (int j = 0; j < kColumns; ++j) function.push_back(std::abs(normal(random)));
    }
  }
  Planted planted;
  Field& field = planted.field;
  field.name = "planted";
  field.points = int64_t{width} * height;
  field.channels = channels;
  field.width = width;
  field.height = height;
  field.functions = MakeFunctionRows(field.points * channels, kColumns);
  int64_t count = 0;
  for (int64_t r = 0; r < field.functions.rows; ++r) {
    const int64_t x = r % field.points % width, channel = r / field.points;
    const int k = static_cast<int>((x * clusters / width + channel) % clusters);
    planted.cluster.push_back(k);
    for (int t = 0; t < terms; ++t) {
      const float weight = 0.2f + std::abs(normal(random));
      for (int j = 0; j < kColumns; ++j) field.functions.Row(r)[j] += weight * bases[k][t][j];
    }
    for (int j = 0; j < kColumns; ++j) {
      if (uniform(random) >= spikes) continue;
      field.functions.Row(r)[j] += 3 * normal(random);
      ++count;
    }
  }
  for (int j = 0; j < kColumns; ++j) {
    const double z = 1 - (2 * j + 1.0) / kColumns, angle = 2.4 * j, s = std::sqrt(1 - z * z);
    field.directions.push_back({s * std::cos(angle), s * std::sin(angle), z});
  }
  planted.spikes =
      static_cast<double>(count) / static_cast<double>(field.functions.rows * kColumns);
  return planted;
}

SparseClusterOptions SmallOptions(int clusters, int terms) {
  SparseClusterOptions options;
  options.clusters = clusters;
  options.terms = terms;
  options.min_cluster = 0.2;
  options.max_cluster = 4;
  options.residual_threshold = 0.02;
  return options;
}

// The share of rows whose cluster is the one that most of their planted cluster are in.
double Purity(const Planted& planted, const ClusteredModel& model) {
  std::map<std::pair<int, int>, int> together;
  for (int64_t r = 0; r < model.rows; ++r) ++together[{model.cluster[r], planted.cluster[r]}];
  std::map<int, int> most;
  for (const auto& [pair, count] : together) most[pair.first] = std::max(most[pair.first], count);
  int right = 0;
  for (const auto& [k, count] : most) right += count;
  return static_cast<double>(right) / static_cast<double>(model.rows);
}

TEST(SparseClusters, RecoversPlantedClustersAndSpikes) {
  for (ClusterStart start : {ClusterStart::kSimilar, ClusterStart::kRandom}) {
    // With as many clusters as planted ones, two of these may end in one: a local minimum.
    const Planted planted = Plant(40, 20, 1, 4, 2, 0.05);
    SparseClusterOptions options = SmallOptions(12, 2);
    options.cluster_start = start;
    options.bootstrap_factor = 1;
    const SparseClusterResult result = ClusterSparse(planted.field, options, SilentProgress());
    CheckModel(result.model);
    EXPECT_GT(Purity(planted, result.model), 0.98);
    const RowsView truth = planted.field.functions.View();
    EXPECT_NEAR(1 - ResidualSparseness(result.model, truth, 0.02), planted.spikes,
                0.2 * planted.spikes);
    EXPECT_LT(RelativeError(result.model, truth, -1), 1e-4);
  }
}

// Averages of nine rows of a basis are still in its span.
TEST(SparseClusters, LowResolutionServesTheFull) {
  const Planted planted = Plant(48, 48, 3, 4, 2, 0.002);
  SparseClusterOptions options = SmallOptions(4, 2);
  options.bootstrap_factor = 3;
  const SparseClusterResult result = ClusterSparse(planted.field, options, SilentProgress());
  EXPECT_EQ(result.bootstrap_factor, 3);
  EXPECT_EQ(result.bootstrap_rows, 3 * 16 * 16);
  EXPECT_GT(Purity(planted, result.model), 0.98);
  EXPECT_NEAR(1 - ResidualSparseness(result.model, planted.field.functions.View(), 0.02),
              planted.spikes, 0.2 * planted.spikes);
}

TEST(SparseClusters, VerticesAreServedByTheirPlaces) {
  Planted planted = Plant(40, 20, 1, 4, 2, 0.01);
  for (int64_t p = 0; p < planted.field.points; ++p) {
    planted.field.positions.push_back({static_cast<float>(p % 40), static_cast<float>(p / 40), 5});
  }
  planted.field.width = planted.field.height = 0;
  SparseClusterOptions options = SmallOptions(4, 2);
  options.bootstrap_factor = 2;
  SparseClusterResult result = ClusterSparse(planted.field, options, SilentProgress());
  EXPECT_LT(result.bootstrap_rows, 800);
  EXPECT_GT(Purity(planted, result.model), 0.95);
  planted.field.positions.clear();
  result = ClusterSparse(planted.field, options, SilentProgress());
  EXPECT_EQ(result.bootstrap_rows, 800);
  EXPECT_GT(Purity(planted, result.model), 0.98);
}

TEST(SparseClusters, SizesHold) {
  const Planted planted = Plant(60, 20, 1, 3, 2, 0.05);
  SparseClusterOptions options = SmallOptions(12, 2);
  options.min_cluster = 0.5;
  options.max_cluster = 2;
  options.bootstrap_factor = 1;
  const SparseClusterResult result = ClusterSparse(planted.field, options, SilentProgress());
  EXPECT_GE(result.clusters, 6);
  EXPECT_GE(result.smallest_cluster, result.smallest_allowed);
  EXPECT_LE(result.largest_cluster, result.largest_allowed);
  EXPECT_LE(result.largest_allowed, 2 * 1200 / 6);
  EXPECT_GE(result.smallest_allowed, 1200 / 24 / 2);
  std::vector<int64_t> sizes(result.model.bases.size());
  for (uint16_t k : result.model.cluster) ++sizes[k];
  EXPECT_EQ(*std::min_element(sizes.begin(), sizes.end()), result.smallest_cluster);
  EXPECT_EQ(*std::max_element(sizes.begin(), sizes.end()), result.largest_cluster);
}

TEST(SparseClusters, DoesNotDependOnTheNumberOfThreads) {
  const Planted planted = Plant(40, 20, 3, 4, 2, 0.05);
  SparseClusterOptions options = SmallOptions(6, 2);
  SetThreadCount(1);
  const ClusteredModel one = ClusterSparse(planted.field, options, SilentProgress()).model;
  SetThreadCount(4);
  const ClusteredModel four = ClusterSparse(planted.field, options, SilentProgress()).model;
  SetThreadCount(0);
  EXPECT_EQ(one.cluster, four.cluster);
  EXPECT_EQ(one.weights, four.weights);
  EXPECT_EQ(one.residual_value, four.residual_value);
  EXPECT_EQ(one.residual_column, four.residual_column);
  ASSERT_EQ(one.bases.size(), four.bases.size());
  for (size_t k = 0; k < one.bases.size(); ++k) {
    EXPECT_EQ(one.bases[k].values, four.bases[k].values);
  }
}

// The residual is taken against the numbers as stored: all of it gives the rows back.
TEST(SparseClusters, LosslessWithoutThreshold) {
  for (FunctionsBasis basis : {FunctionsBasis::kNone, FunctionsBasis::kHaar}) {
    const Planted planted = Plant(20, 10, 1, 3, 2, 0.1);
    SparseClusterOptions options = SmallOptions(3, 1);
    options.residual_threshold = 0;
    options.functions_basis = basis;
    const SparseClusterResult result = ClusterSparse(planted.field, options, SilentProgress());
    FunctionRows rows = MakeFunctionRows(200, kColumns);
    for (int64_t r = 0; r < 200; ++r) EvaluateRow(result.model, r, -1, rows.Row(r));
    EXPECT_EQ(result.haar.has_value(), basis == FunctionsBasis::kHaar);
    if (result.haar) rows = FromHaar(*result.haar, rows);
    double off = 0, energy = 0;
    for (size_t i = 0; i < rows.values.size(); ++i) {
      off += std::pow(double{rows.values[i]} - planted.field.functions.values[i], 2);
      energy += std::pow(double{planted.field.functions.values[i]}, 2);
    }
    EXPECT_LT(off, 1e-6 * energy);
  }
}

TEST(SparseClusters, APositiveResidualIsNowhereNegative) {
  const Planted planted = Plant(20, 10, 1, 2, 2, 0.1);
  Field field = planted.field;
  for (float& v : field.functions.values) v = std::abs(v);
  SparseClusterOptions options = SmallOptions(2, 2);
  options.residual_sign = ResidualSign::kPositive;
  const SparseClusterResult result = ClusterSparse(field, options, SilentProgress());
  EXPECT_FALSE(result.model.residual_value.empty());
  for (float v : result.model.residual_value) EXPECT_GT(v, -0.02);
}

Field FieldOf(int width, int height, int columns, const std::function<float(int64_t, int)>& value) {
  Field field;
  field.name = "made";
  field.points = int64_t{width} * height;
  field.width = width;
  field.height = height;
  field.functions = MakeFunctionRows(field.points, columns);
  field.directions.assign(static_cast<size_t>(columns), Eigen::Vector3d(0, 0, 1));
  for (int64_t r = 0; r < field.points; ++r) {
    for (int j = 0; j < columns; ++j) field.functions.Row(r)[j] = value(r, j);
  }
  return field;
}

double ErrorOf(const Field& field, const SparseClusterOptions& options) {
  const SparseClusterResult result = ClusterSparse(field, options, SilentProgress());
  CheckModel(result.model);
  return RelativeError(result.model, field.functions.View(), -1);
}

TEST(SparseClusters, Extremes) {
  SparseClusterOptions options;
  options.residual_threshold = 0;
  const auto some = [](int64_t r, int j) {
    return 0.1f * static_cast<float>((r * 7 + j * 3) % 11);
  };
  EXPECT_LT(ErrorOf(FieldOf(8, 8, 1, some), options), 1e-6) << "one light";
  EXPECT_LT(ErrorOf(FieldOf(1, 1, 9, some), options), 1e-6) << "one pixel";
  EXPECT_LT(ErrorOf(FieldOf(1, 1, 1, some), options), 1e-6) << "one number";
  EXPECT_LT(ErrorOf(FieldOf(8, 8, 3, some), options), 1e-6) << "more terms than lights";
  EXPECT_LT(ErrorOf(FieldOf(3, 1, 20, some), options), 1e-6) << "clusters of one";
  options.clusters = 5;
  const Field equal = FieldOf(20, 20, 9, [](int64_t, int j) { return 0.1f + 0.1f * j; });
  EXPECT_LT(ErrorOf(equal, options), 1e-6);
  options.residuals = 0;
  EXPECT_LT(ErrorOf(equal, options), 1e-5);
}

// Each row has one number: leaving all of it over is as good as any function.
TEST(SparseClusters, RowsOfOneNumber) {
  const Field field = FieldOf(
      12, 12, 40, [](int64_t r, int j) { return j == static_cast<int>(r * 7 % 40) ? 0.5f : 0.0f; });
  SparseClusterOptions options;
  options.clusters = 4;
  EXPECT_LT(ErrorOf(field, options), 1e-6);
}

TEST(SparseClusters, ABlackFieldHasNoFunctions) {
  const Field black = FieldOf(9, 5, 7, [](int64_t, int) { return 0.0f; });
  const SparseClusterResult result = ClusterSparse(black, {}, SilentProgress());
  CheckModel(result.model);
  EXPECT_EQ(result.clusters, 0);
  EXPECT_EQ(result.dark_rows, 45);
  EXPECT_TRUE(result.model.weights.empty());
  EXPECT_EQ(RelativeError(result.model, black.functions.View(), -1), 0);
  Field none = black;
  none.points = 0;
  none.width = none.height = 0;
  none.functions = MakeFunctionRows(0, 7);
  CheckModel(ClusterSparse(none, {}, SilentProgress()).model);
}

TEST(SparseClusters, NeighboursThatCancelAreClusteredAtFullResolution) {
  Field field;
  field.name = "checkerboard";
  field.width = field.height = 4;
  field.points = 16;
  field.functions = MakeFunctionRows(16, 5);
  field.directions.assign(5, Eigen::Vector3d::UnitZ());
  for (int64_t r = 0; r < 16; ++r) {
    const float sign = (r + r / 4) % 2 == 0 ? 1 : -1;
    for (int i = 0; i < 5; ++i) field.functions.Row(r)[i] = sign * static_cast<float>(i + 1);
  }
  for (const ClusterStart start : {ClusterStart::kSimilar, ClusterStart::kRandom}) {
    SparseClusterOptions options;
    options.clusters = 2;
    options.terms = 1;
    options.bootstrap_factor = 2;
    options.cluster_start = start;
    const SparseClusterResult result = ClusterSparse(field, options, SilentProgress());
    EXPECT_EQ(result.bootstrap_factor, 1);
    EXPECT_LT(RelativeError(result.model, field.functions.View(), -1), 1e-5);
  }
}

TEST(SparseClusters, AnyScale) {
  for (float scale : {1e-25f, 1e6f, 1e25f}) {
    Planted planted = Plant(20, 10, 1, 2, 2, 0.05);
    for (float& v : planted.field.functions.values) v *= scale;
    SparseClusterOptions options = SmallOptions(2, 2);
    options.residual_threshold = 0.02 * scale;
    options.bootstrap_factor = 1;
    const SparseClusterResult result = ClusterSparse(planted.field, options, SilentProgress());
    EXPECT_GT(Purity(planted, result.model), 0.98) << scale;
    EXPECT_LT(RelativeError(result.model, planted.field.functions.View(), -1), 1e-4) << scale;
  }
}

TEST(SparseClusters, RefusesWhatItCannotTake) {
  Field field = FieldOf(4, 4, 5, [](int64_t, int) { return 1.0f; });
  SparseClusterOptions options;
  options.terms = 0;
  EXPECT_THROW(ClusterSparse(field, options, SilentProgress()), Error);
  options = {};
  options.max_cluster = 1;
  EXPECT_THROW(ClusterSparse(field, options, SilentProgress()), Error);
  field.width = 3;
  EXPECT_THROW(ClusterSparse(field, {}, SilentProgress()), Error);
  field.width = 4;
  field.functions.Row(2)[1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(ClusterSparse(field, {}, SilentProgress()), Error);
}

}  // namespace
}  // namespace lfm
