// SPDX-License-Identifier: BSD-3-Clause
#include "fields/dimension.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

#include "core/error.h"

namespace lfm {
namespace {

// Rows whose squared singular values are `energies`.
FunctionRows Planted(int rows, int columns, const std::vector<double>& energies) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto rank = static_cast<int>(energies.size());
  const auto orthonormal = [&](int size) {
    Eigen::MatrixXd matrix(size, rank);
    for (double& value : matrix.reshaped()) value = normal(random);
    return Eigen::MatrixXd(Eigen::HouseholderQR<Eigen::MatrixXd>(matrix).householderQ() *
                           Eigen::MatrixXd::Identity(size, rank));
  };
  const Eigen::VectorXd sigma =
      Eigen::Map<const Eigen::VectorXd>(energies.data(), rank).cwiseSqrt();
  const Eigen::MatrixXd product =
      orthonormal(rows) * sigma.asDiagonal() * orthonormal(columns).transpose();
  FunctionRows result = MakeFunctionRows(rows, columns);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) result.Row(r)[c] = static_cast<float>(product(r, c));
  }
  return result;
}

TEST(Dimension, PlantedEnergiesAreCounted) {
  // 90, 99, 99.9, 99.99 and 100 % of 10000.
  const std::vector<double> energies = {9000, 900, 90, 9, 1};
  for (const auto& [rows, columns] : {std::pair{40, 70}, std::pair{70, 40}, std::pair{5, 5}}) {
    const FunctionRows planted = Planted(rows, columns, energies);
    EXPECT_EQ(DimensionOf(planted.View(), 0.89), 1);
    EXPECT_EQ(DimensionOf(planted.View(), 0.95), 2);
    EXPECT_EQ(DimensionOf(planted.View(), 0.9985), 3);
    EXPECT_EQ(DimensionOf(planted.View(), 0.9995), 4);
    EXPECT_EQ(DimensionOf(planted.View(), 0.99995), 5);
  }
}

TEST(Dimension, EqualEnergiesNeedTheirShare) {
  const FunctionRows planted = Planted(100, 80, std::vector<double>(50, 2.0));
  EXPECT_EQ(DimensionOf(planted.View(), 0.501), 26);
  EXPECT_EQ(DimensionOf(planted.View(), 0.979), 49);
}

// Large enough for subspaces: geometric energies, of which 99.95 % stand in 150 terms.
TEST(Dimension, LargeMatricesAgreeWithTheSpectrum) {
  std::vector<double> energies;
  for (int i = 0; i < 500; ++i) energies.push_back(std::pow(0.0005, i / 150.0) + 1e-7);
  const int expected = DimensionOf(energies, 0.9995);
  const FunctionRows planted = Planted(600, 520, energies);
  for (const int guess : {0, 20, 150, 500}) {
    EXPECT_NEAR(DimensionOf(planted.View(), 0.9995, guess), expected, 1) << guess;
  }
}

TEST(Dimension, ScaleDoesNotMatter) {
  FunctionRows planted = Planted(20, 30, {100, 1, 0.01});
  for (const float scale : {1e-20f, 1e15f}) {
    FunctionRows scaled = planted;
    for (float& value : scaled.values) value *= scale;
    EXPECT_EQ(DimensionOf(scaled.View(), 0.999), 2) << scale;
  }
}

TEST(Dimension, Extremes) {
  FunctionRows black = MakeFunctionRows(6, 9);
  EXPECT_EQ(DimensionOf(black.View(), 0.9995), 0);
  EXPECT_EQ(DimensionOf(MakeFunctionRows(0, 9).View(), 0.9995), 0);
  for (float& value : black.values) value = 2;
  EXPECT_EQ(DimensionOf(black.View(), 0.9995), 1);  // all equal
  EXPECT_EQ(DimensionOf(GatherRows(black.View(), {0}).View(), 1), 1);
  black.Row(3)[2] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(DimensionOf(black.View(), 0.9995), Error);
  EXPECT_THROW(DimensionOf(MakeFunctionRows(1, 1).View(), 1.5), Error);
  EXPECT_THROW(DimensionOf(std::vector<double>{1}, -0.1), Error);
  EXPECT_EQ(DimensionOf(std::vector<double>{}, 0.9), 0);
  EXPECT_EQ(DimensionOf(std::vector<double>{4, 4, -1e-9}, 0.9), 2);
}

}  // namespace
}  // namespace lfm
