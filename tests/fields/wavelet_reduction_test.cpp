// SPDX-License-Identifier: BSD-3-Clause
#include "fields/wavelet_reduction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/error.h"
#include "fields/matrix_products.h"

namespace lfm {
namespace {

FunctionRows RandomRows(int64_t rows, int columns, uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  FunctionRows result = MakeFunctionRows(rows, columns);
  for (int64_t i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) result.Row(i)[j] = normal(random);
  }
  return result;
}

constexpr double kRounding_rel = 1e-5;

TEST(WaveletReduction, IsOrthonormalOnEveryGrid) {
  for (const ColumnGrid grid :
       {ColumnGrid{6, 4, 4}, {1, 1, 253}, {2, 5, 3}, {1, 7, 1}, {1, 1, 1}}) {
    const FunctionRows rows = RandomRows(2, grid.columns(), 1);
    FunctionRows turned = rows;
    double before = 0, after = 0;
    for (int i = 0; i < 2; ++i) TransformHaar(grid, turned.Row(i));
    for (int j = 0; j < grid.columns(); ++j) {
      before += double{rows.Row(0)[j]} * rows.Row(1)[j];
      after += double{turned.Row(0)[j]} * turned.Row(1)[j];
    }
    EXPECT_NEAR(after, before, kRounding_rel * grid.columns());
    InvertHaar(grid, turned.Row(0));
    for (int j = 0; j < grid.columns(); ++j) EXPECT_NEAR(turned.Row(0)[j], rows.Row(0)[j], 1e-5);
  }
}

// [a b; c d]: average, then differences across, down and diagonal.
TEST(WaveletReduction, IsHaarsTransform) {
  float row[] = {1, 2, 3, 6};
  TransformHaar({1, 2, 2}, row);
  EXPECT_NEAR(row[0], 6, 1e-6);
  EXPECT_NEAR(row[1], -2, 1e-6);  // ((1 + 3) - (2 + 6)) / 2
  EXPECT_NEAR(row[2], -3, 1e-6);
  EXPECT_NEAR(row[3], 1, 1e-6);  // ((1 + 6) - (2 + 3)) / 2
}

TEST(WaveletReduction, KeepsWhatHoldsMostEnergyOverAllRows) {
  const ColumnGrid grid = {6, 4, 4};
  FunctionRows rows = MakeFunctionRows(20, grid.columns());
  for (int i = 0; i < 20; ++i) {
    rows.Row(i)[0] = 3;  // face 0's average
    rows.Row(i)[16 + 5] = i == 0 ? 50.0f : 1.0f;
    rows.Row(i)[95] = 0.01f;
    InvertHaar(grid, rows.Row(i));
  }
  const WaveletReduction reduction = ReduceByWavelets(rows.View(), grid, 2);
  EXPECT_EQ(reduction.kept, (std::vector<int>{0, 21}));
  EXPECT_NEAR(reduction.rows.Row(0)[1], 50, 1e-4);
  EXPECT_NEAR(reduction.rows.Row(7)[0], 3, 1e-5);
  EXPECT_LT(reduction.kept_share, 1);
  EXPECT_GT(reduction.kept_share, 0.9999);
}

TEST(WaveletReduction, WithAllCoefficientsKeepsDistances) {
  const FunctionRows rows = RandomRows(9, 6 * 8 * 8, 2);
  const WaveletReduction reduction =
      ReduceByWavelets(rows.View(), GridOfColumns(rows.columns), 100000);
  EXPECT_EQ(reduction.rows.columns, rows.columns);
  EXPECT_NEAR(reduction.kept_share, 1, 1e-12);
  const Eigen::MatrixXd truth = GramOfRows(rows.View());
  EXPECT_LT((GramOfRows(reduction.rows.View()) - truth).norm(), kRounding_rel * truth.norm());
}

TEST(WaveletReduction, FindsTheGridOfACube) {
  EXPECT_EQ(GridOfColumns(6144).width, 32);
  EXPECT_EQ(GridOfColumns(6144).faces, 6);
  EXPECT_EQ(GridOfColumns(253).width, 253);
  EXPECT_EQ(GridOfColumns(6).faces, 1);
  EXPECT_EQ(GridOfColumns(1).columns(), 1);
}

TEST(WaveletReduction, HoldsExtremesAndRejectsNonsense) {
  FunctionRows black = MakeFunctionRows(3, 24);
  EXPECT_EQ(ReduceByWavelets(black.View(), GridOfColumns(24), 4).kept_share, 1);
  EXPECT_EQ(ReduceByWavelets(MakeFunctionRows(0, 24).View(), GridOfColumns(24), 4).rows.rows, 0);
  EXPECT_THROW(ReduceByWavelets(black.View(), GridOfColumns(24), 0), Error);
  EXPECT_THROW(ReduceByWavelets(black.View(), GridOfColumns(25), 4), Error);
  black.Row(1)[3] = INFINITY;
  EXPECT_THROW(ReduceByWavelets(black.View(), GridOfColumns(24), 4), Error);
}

}  // namespace
}  // namespace lfm
