// SPDX-License-Identifier: BSD-3-Clause
#include "fields/matrix_products.h"

#include <gtest/gtest.h>

#include <random>

#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

FunctionRows RandomRows(int64_t rows, int columns, uint32_t seed, float scale = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  FunctionRows result = MakeFunctionRows(rows, columns);
  for (int64_t i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) result.Row(i)[j] = scale * normal(random);
  }
  return result;
}

Eigen::MatrixXd Dense(RowsView rows) {
  Eigen::MatrixXd m(rows.rows, rows.columns);
  for (int64_t i = 0; i < rows.rows; ++i) {
    for (int j = 0; j < rows.columns; ++j) m(i, j) = rows.Row(i)[j];
  }
  return m;
}

constexpr double kSingle_rel = 2e-6, kDouble_rel = 1e-13;

double Difference_rel(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).norm() / b.norm();
}

// Sizes on both sides of every block and tile.
const int kSizes[][3] = {{1, 1, 1},     {1, 7, 3},      {8, 128, 24},   {9, 129, 25},
                         {65, 40, 130}, {257, 300, 31}, {20, 1500, 40}, {1100, 3, 140}};

TEST(MatrixProducts, AgreeWithDenseOnesOfAnySize) {
  for (const auto& [rows, depth, columns] : kSizes) {
    const FunctionRows a = RandomRows(rows, depth, 1), b = RandomRows(depth, columns, 2);
    const Eigen::MatrixXd truth = Dense(a.View()) * Dense(b.View());
    EXPECT_LT(Difference_rel(Dense(Times(a.View(), b.View()).View()), truth), kSingle_rel);
    const FunctionRows bt = TransposeRows(b.View()), at = TransposeRows(a.View());
    EXPECT_LT(Difference_rel(Dense(TimesTransposed(a.View(), bt.View()).View()), truth),
              kSingle_rel);
    EXPECT_LT(Difference_rel(Dense(TransposedTimes(at.View(), b.View()).View()), truth),
              kSingle_rel);
    EXPECT_LT(Difference_rel(TransposedTimes(Dense(at.View()), b.View()), truth), kDouble_rel);
  }
}

TEST(MatrixProducts, GramMatricesAreExactAndSymmetric) {
  for (const auto& [rows, columns, unused] : kSizes) {
    const FunctionRows a = RandomRows(rows, columns, 3);
    const Eigen::MatrixXd dense = Dense(a.View());
    const Eigen::MatrixXd of_rows = GramOfRows(a.View()), of_columns = GramOfColumns(a.View());
    EXPECT_LT(Difference_rel(of_rows, dense * dense.transpose()), kDouble_rel);
    EXPECT_LT(Difference_rel(of_columns, dense.transpose() * dense), kDouble_rel);
    EXPECT_EQ(of_rows, of_rows.transpose());
    EXPECT_EQ(of_columns, of_columns.transpose());
    EXPECT_NEAR(EnergyOf(a.View()), dense.squaredNorm(), kDouble_rel * dense.squaredNorm());
  }
}

// The product's padding takes no part, whatever lies in the stride.
TEST(MatrixProducts, LeaveOutWhatLiesBetweenTheRows) {
  FunctionRows a = RandomRows(5, 7, 4);
  const Eigen::MatrixXd clean = GramOfRows(a.View());
  for (int64_t i = 0; i < a.rows; ++i) a.Row(i)[7] = 1e30f;
  EXPECT_EQ(GramOfRows(a.View()), clean);
}

TEST(MatrixProducts, HoldExtremeMagnitudes) {
  for (const float scale : {1e-25f, 1e25f}) {
    const FunctionRows a = RandomRows(30, 200, 5, scale);
    const Eigen::MatrixXd dense = Dense(a.View());
    EXPECT_LT(Difference_rel(GramOfRows(a.View()), dense * dense.transpose()), kDouble_rel);
  }
}

TEST(MatrixProducts, DoNotDependOnTheNumberOfThreads) {
  const FunctionRows a = RandomRows(700, 300, 6), b = RandomRows(300, 500, 7);
  SetThreadCount(1);
  const FunctionRows one = Times(a.View(), b.View());
  const Eigen::MatrixXd gram = GramOfRows(a.View());
  SetThreadCount(3);
  EXPECT_EQ(Times(a.View(), b.View()).values, one.values);
  EXPECT_EQ(GramOfRows(a.View()), gram);
  SetThreadCount(0);
}

TEST(MatrixProducts, RejectSidesThatDoNotFit) {
  const FunctionRows a = RandomRows(3, 4, 8), b = RandomRows(5, 4, 9);
  EXPECT_THROW(Times(a.View(), b.View()), Error);
  EXPECT_THROW(TransposedTimes(a.View(), b.View()), Error);
  EXPECT_NO_THROW(TimesTransposed(a.View(), b.View()));
}

TEST(MatrixProducts, OfNothingAreEmpty) {
  const FunctionRows none = MakeFunctionRows(0, 4), b = RandomRows(5, 4, 9);
  EXPECT_EQ(TimesTransposed(b.View(), b.View()).rows, 5);
  EXPECT_EQ(TimesTransposed(none.View(), b.View()).rows, 0);
  EXPECT_EQ(GramOfColumns(none.View()), Eigen::MatrixXd::Zero(4, 4));
  EXPECT_EQ(EnergyOf(none.View()), 0);
}

}  // namespace
}  // namespace lfm
