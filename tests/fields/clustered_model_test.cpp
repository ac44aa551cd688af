// SPDX-License-Identifier: BSD-3-Clause
#include "fields/clustered_model.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "core/error.h"

namespace lfm {
namespace {

FunctionRows Basis(const std::vector<std::vector<float>>& functions, int columns) {
  FunctionRows basis = MakeFunctionRows(static_cast<int64_t>(functions.size()), columns);
  for (int64_t t = 0; t < basis.rows; ++t) {
    std::copy(functions[t].begin(), functions[t].end(), basis.Row(t));
  }
  return basis;
}

/// Three rows of three columns: two in a cluster of two terms, one in a cluster without any.
ClusteredModel SmallModel() {
  ClusteredModel model;
  model.rows = 3;
  model.columns = 3;
  model.cluster = {0, 1, 0};
  model.bases = {Basis({{1, 0, 1}, {0, 2, 0}}, 3), MakeFunctionRows(0, 3)};
  model.first_weight = {0, 2, 2};
  model.weights = {1, 2, 3, 4};
  model.first_residual = {0, 2, 3, 3};
  model.residual_column = {2, 0, 1};
  model.residual_value = {-5, 0.5f, 7};
  return model;
}

std::vector<float> Row(const ClusteredModel& model, int64_t row, int residuals) {
  std::vector<float> out(static_cast<size_t>(model.columns));
  EvaluateRow(model, row, residuals, out.data());
  return out;
}

TEST(ClusteredModel, ARowIsItsWeightedBasisAndItsLeadingResiduals) {
  const ClusteredModel model = SmallModel();
  EXPECT_EQ(Row(model, 0, 0), (std::vector<float>{1, 4, 1}));
  EXPECT_EQ(Row(model, 0, 1), (std::vector<float>{1, 4, -4}));
  EXPECT_EQ(Row(model, 0, -1), (std::vector<float>{1.5f, 4, -4}));
  EXPECT_EQ(Row(model, 1, 0), (std::vector<float>{0, 0, 0}));
  EXPECT_EQ(Row(model, 1, 9), (std::vector<float>{0, 7, 0}));
  EXPECT_EQ(Row(model, 2, -1), (std::vector<float>{3, 8, 3}));
}

TEST(ClusteredModel, RelativeErrorIsTheMeanOverRowsWithEnergy) {
  const ClusteredModel model = SmallModel();
  FunctionRows truth = MakeFunctionRows(3, 3);
  // Row 0: off by 1 of energy 1 + 16 + 9; row 1 has none; row 2 is met.
  const float rows[3][3] = {{1, 4, -3}, {0, 0, 0}, {3, 8, 3}};
  for (int r = 0; r < 3; ++r) std::copy_n(rows[r], 3, truth.Row(r));
  EXPECT_DOUBLE_EQ(RelativeError(model, truth.View(), 1), 0.5 * (1.0 / 26));
  EXPECT_DOUBLE_EQ(RelativeError(model, truth.View(), 1, {2}), 0);
  EXPECT_DOUBLE_EQ(RelativeError(model, truth.View(), 1, {1}), 0);
}

TEST(ClusteredModel, TablesThatDoNotFitAreRefused) {
  EXPECT_NO_THROW(CheckModel(SmallModel()));
  const auto broken = [](const std::function<void(ClusteredModel&)>& spoil) {
    ClusteredModel model = SmallModel();
    spoil(model);
    return model;
  };
  EXPECT_THROW(CheckModel(broken([](auto& m) { m.cluster[1] = 2; })), Error);
  EXPECT_THROW(CheckModel(broken([](auto& m) { m.cluster.pop_back(); })), Error);
  EXPECT_THROW(CheckModel(broken([](auto& m) { m.first_weight[2] = 3; })), Error);
  EXPECT_THROW(CheckModel(broken([](auto& m) { m.first_weight[0] = -1; })), Error);
  EXPECT_THROW(CheckModel(broken([](auto& m) { m.first_residual[1] = 5; })), Error);
  EXPECT_THROW(CheckModel(broken([](auto& m) { m.residual_column[0] = 3; })), Error);
  EXPECT_THROW(CheckModel(broken([](auto& m) {
                 m.bases[0] = Basis({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}, 3);
                 m.first_weight = {0, 4, 4};
                 m.weights.resize(8);
               })),
               Error);
  EXPECT_THROW(CheckModel(broken([](auto& m) {
                 m.first_residual = {0, 4, 4, 4};
                 m.residual_column = {0, 1, 2, 0};
                 m.residual_value = {4, 3, 2, 1};
               })),
               Error);
  EXPECT_THROW(
      CheckModel(broken([](auto& m) { m.weights[0] = std::numeric_limits<float>::quiet_NaN(); })),
      Error);
  EXPECT_THROW(CheckModel(broken(
                   [](auto& m) { m.bases[0].Row(0)[0] = std::numeric_limits<float>::infinity(); })),
               Error);
}

}  // namespace
}  // namespace lfm
