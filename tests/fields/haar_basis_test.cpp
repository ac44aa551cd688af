// SPDX-License-Identifier: BSD-3-Clause
#include "fields/haar_basis.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "core/error.h"

namespace lfm {
namespace {

std::vector<Eigen::Vector3d> Scattered(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < count; ++i) {
    directions.push_back(
        Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized());
  }
  return directions;
}

FunctionRows Identity(int columns) {
  FunctionRows rows = MakeFunctionRows(columns, columns);
  for (int i = 0; i < columns; ++i) rows.Row(i)[i] = 1;
  return rows;
}

double Dot(const float* a, const float* b, int count) {
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += double{a[i]} * b[i];
  return sum;
}

TEST(HaarBasis, IsOrthonormalForAnyNumberOfDirections) {
  for (int count : {1, 2, 3, 7, 64, 253}) {
    const HaarBasis basis = MakeHaarBasis(Scattered(count, 3));
    EXPECT_EQ(basis.steps.size(), static_cast<size_t>(count - 1));
    const FunctionRows psi = ToHaar(basis, Identity(count));
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < count; ++j) {
        EXPECT_NEAR(Dot(psi.Row(i), psi.Row(j), count), i == j ? 1 : 0, 1e-6) << count;
      }
    }
  }
}

TEST(HaarBasis, GoesThereAndBack) {
  const HaarBasis basis = MakeHaarBasis(Scattered(101, 5));
  std::mt19937 random(9);
  std::uniform_real_distribution<float> uniform(-1, 1);
  FunctionRows rows = MakeFunctionRows(20, 101);
  for (int64_t r = 0; r < rows.rows; ++r) {
    for (int j = 0; j < rows.columns; ++j) rows.Row(r)[j] = uniform(random);
  }
  const FunctionRows back = FromHaar(basis, ToHaar(basis, rows));
  for (size_t i = 0; i < rows.values.size(); ++i) EXPECT_NEAR(back.values[i], rows.values[i], 1e-6);
}

TEST(HaarBasis, AConstantIsOneCoefficientAndALightMayBeTransformedInstead) {
  const int count = 37;
  const HaarBasis basis = MakeHaarBasis(Scattered(count, 1));
  FunctionRows rows = MakeFunctionRows(2, count);
  for (int j = 0; j < count; ++j) {
    rows.Row(0)[j] = 2;
    rows.Row(1)[j] = static_cast<float>(j % 5);
  }
  const FunctionRows there = ToHaar(basis, rows);
  int beyond_noise = 0;
  for (int j = 0; j < count; ++j) beyond_noise += std::abs(there.Row(0)[j]) > 1e-5 ? 1 : 0;
  EXPECT_EQ(beyond_noise, 1);
  EXPECT_NEAR(Dot(there.Row(0), there.Row(1), count), Dot(rows.Row(0), rows.Row(1), count), 1e-4);
}

// Two tight groups far apart: the only coefficient that tells the groups apart is the last.
TEST(HaarBasis, PairsNearestDirectionsFirst) {
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < 4; ++i) directions.push_back({std::sin(0.01 * i), 0, std::cos(0.01 * i)});
  for (int i = 0; i < 4; ++i) directions.push_back({0, std::cos(0.01 * i), std::sin(0.01 * i)});
  const HaarBasis basis = MakeHaarBasis(directions);
  FunctionRows step = MakeFunctionRows(1, 8);
  for (int j = 0; j < 8; ++j) step.Row(0)[j] = j < 4 ? 1.0f : 0.0f;
  const FunctionRows there = ToHaar(basis, step);
  int beyond_noise = 0;
  for (int j = 0; j < 8; ++j) beyond_noise += std::abs(there.Row(0)[j]) > 1e-6 ? 1 : 0;
  EXPECT_EQ(beyond_noise, 2);
}

TEST(HaarBasis, TakesRepeatedAndOppositeDirections) {
  const std::vector<Eigen::Vector3d> directions = {{0, 0, 1}, {0, 0, 1}, {0, 0, -1}, {0, 0, -1}};
  const FunctionRows psi = ToHaar(MakeHaarBasis(directions), Identity(4));
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(Dot(psi.Row(i), psi.Row(i), 4), 1, 1e-6);
}

TEST(HaarBasis, RefusesWhatItCannotTake) {
  EXPECT_THROW(MakeHaarBasis({}), Error);
  EXPECT_THROW(MakeHaarBasis({{0, 0, std::numeric_limits<double>::quiet_NaN()}}), Error);
  EXPECT_THROW(ToHaar(MakeHaarBasis(Scattered(3, 1)), MakeFunctionRows(1, 4)), Error);
  EXPECT_THROW(FromHaar(MakeHaarBasis(Scattered(3, 1)), MakeFunctionRows(1, 2)), Error);
}

}  // namespace
}  // namespace lfm
