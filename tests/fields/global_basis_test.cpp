// SPDX-License-Identifier: BSD-3-Clause
#include "fields/global_basis.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "fields/clustered_pca.h"
#include "fields/matrix_products.h"
#include "fields/matrix_terms.h"
#include "planted_rows.h"

namespace lfm {
namespace {

struct Example {
  FunctionRows rows = PlantedRows(5, 30, 3, 80, 1);
  ClusteredModel model = ModelOfClusters(
      rows.View(), ClusterRows(rows.View(), {.clusters = 5, .terms = 3}), {.energy_share = 0.9999});
};

double Difference(const ClusteredModel& a, const ClusteredModel& b) {
  double sum = 0;
  std::vector<float> x(a.columns), y(a.columns);
  for (int64_t row = 0; row < a.rows; ++row) {
    EvaluateRow(a, row, -1, x.data());
    EvaluateRow(b, row, -1, y.data());
    for (int j = 0; j < a.columns; ++j) sum += std::pow(double{x[j]} - y[j], 2);
  }
  return sum;
}

TEST(GlobalBasis, AddsNoErrorWhereItHoldsAll) {
  const Example e;
  const GlobalBasis global = GlobalBasisOfModel(e.model, {.energy_share = 1});
  EXPECT_EQ(global.functions.rows, 15);  // 5 clusters of 3
  EXPECT_LT(Difference(e.model, ThroughGlobalBasis(e.model, global)),
            1e-9 * EnergyOf(e.rows.View()));
}

// Weighed by the rows' weights, the second SVD is that of the approximated rows: what N functions
// leave out is what the spectrum says.
TEST(GlobalBasis, LeavesOutWhatTheSpectrumSays) {
  const Example e;
  FunctionRows approximated = MakeFunctionRows(e.rows.rows, e.rows.columns);
  for (int64_t row = 0; row < e.rows.rows; ++row) {
    EvaluateRow(e.model, row, -1, approximated.Row(row));
  }
  const std::vector<double> spectrum = EnergySpectrum(approximated.View());
  for (const int terms : {2, 6, 11}) {
    double left_out = 0;
    for (size_t k = terms; k < spectrum.size(); ++k) left_out += spectrum[k];
    const GlobalBasis global = GlobalBasisOfModel(e.model, {.energy_share = 1, .max_terms = terms});
    EXPECT_EQ(global.functions.rows, terms);
    EXPECT_NEAR(Difference(e.model, ThroughGlobalBasis(e.model, global)), left_out,
                1e-4 * left_out);
    // A subset of the rows does worse, but not by much.
    std::vector<int64_t> some;
    for (int64_t row = 0; row < e.rows.rows; row += 2) some.push_back(row);
    const GlobalBasis of_rows = GlobalBasisOfRows(e.model, GatherRows(e.rows.View(), some).View(),
                                                  {.energy_share = 1, .max_terms = terms});
    const double of_subset = Difference(e.model, ThroughGlobalBasis(e.model, of_rows));
    EXPECT_GE(of_subset, left_out * (1 - 1e-4));
    EXPECT_LT(of_subset, 1.5 * left_out);
  }
}

TEST(GlobalBasis, RelightsAsTheModelDoes) {
  const Example e;
  const GlobalBasis global = GlobalBasisOfModel(e.model, {.energy_share = 1});
  std::vector<float> light(80);
  for (int j = 0; j < 80; ++j) light[j] = 0.5f + std::sin(0.3f * j);
  const std::vector<float> direct = Relit(e.model, light), through = Relit(e.model, global, light);
  std::vector<float> row(80);
  for (int64_t i = 0; i < e.rows.rows; ++i) {
    EvaluateRow(e.model, i, -1, row.data());
    double truth = 0;
    for (int j = 0; j < 80; ++j) truth += double{row[j]} * light[j];
    EXPECT_NEAR(direct[i], truth, 1e-3);
    EXPECT_NEAR(through[i], truth, 1e-3);
  }
}

TEST(GlobalBasis, HoldsExtremesAndRejectsNonsense) {
  const FunctionRows black = MakeFunctionRows(4, 6);
  const ClusteredModel model =
      ModelOfClusters(black.View(), ClusterRows(black.View(), {.clusters = 2}), {});
  const GlobalBasis global = GlobalBasisOfModel(model, {});
  EXPECT_EQ(global.functions.rows, 0);
  EXPECT_EQ(Relit(model, global, std::vector<float>(6, 1)), std::vector<float>(4, 0));
  CheckModel(ThroughGlobalBasis(model, global));
  EXPECT_THROW(Relit(model, std::vector<float>(5)), Error);
  EXPECT_THROW(ThroughGlobalBasis(Example().model, global), Error);
  EXPECT_THROW(GlobalBasisOfRows(model, MakeFunctionRows(3, 7).View(), {}), Error);
  // Terms that the global functions hold nothing of.
  const Example e;
  const GlobalBasis none = GlobalBasisOfRows(e.model, MakeFunctionRows(3, 80).View(), {});
  EXPECT_EQ(none.functions.rows, 0);
  CheckModel(ThroughGlobalBasis(e.model, none));
  EXPECT_EQ(Relit(e.model, none, std::vector<float>(80, 1))[3], 0);
}

}  // namespace
}  // namespace lfm
