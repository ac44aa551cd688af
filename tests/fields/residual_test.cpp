// SPDX-License-Identifier: BSD-3-Clause
#include "fields/residual.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/stored_numbers.h"

namespace lfm {
namespace {

struct Problem {
  ClusteredModel model;
  FunctionRows truth;
};

// Rows of one function each in two clusters, and a truth of random numbers on a coarse grid, so
// that magnitudes tie.
Problem RandomProblem(int rows, int columns, float scale) {
  std::mt19937 random(11);
  std::uniform_int_distribution<int> grid(-8, 8);
  Problem problem;
  problem.truth = MakeFunctionRows(rows, columns);
  ClusteredModel& model = problem.model;
  model.rows = rows;
  model.columns = columns;
  model.bases = {MakeFunctionRows(1, columns), MakeFunctionRows(1, columns)};
  for (FunctionRows& basis : model.bases) {
    for (int j = 0; j < columns; ++j) basis.Row(0)[j] = 0.5f * static_cast<float>(grid(random));
  }
  for (int r = 0; r < rows; ++r) {
    model.cluster.push_back(static_cast<uint16_t>(r % 2));
    model.first_weight.push_back(r);
    model.weights.push_back(scale * static_cast<float>(grid(random)));
    for (int j = 0; j < columns; ++j) {
      problem.truth.Row(r)[j] = scale * static_cast<float>(grid(random));
    }
  }
  return problem;
}

std::vector<float> Errors(const Problem& problem, int64_t row) {
  std::vector<float> errors(static_cast<size_t>(problem.model.columns));
  EvaluateRow(problem.model, row, 0, errors.data());
  for (int j = 0; j < problem.model.columns; ++j) {
    errors[j] = problem.truth.Row(row)[j] - errors[j];
  }
  return errors;
}

TEST(Residual, KeepsTheLargestAsBruteForceDoes) {
  const Problem problem = RandomProblem(50, 23, 1);
  for (int largest : {0, 1, 5, 22, 23, 40}) {
    const float threshold = 3;
    const ClusteredModel model =
        WithResidual(problem.model, problem.truth.View(), {largest, threshold});
    CheckModel(model);
    for (int64_t r = 0; r < model.rows; ++r) {
      std::vector<float> errors = Errors(problem, r);
      for (int64_t at = model.first_residual[r]; at < model.first_residual[r + 1]; ++at) {
        int best = 0;
        for (int j = 1; j < model.columns; ++j) {
          if (std::abs(errors[j]) > std::abs(errors[best])) best = j;
        }
        ASSERT_EQ(model.residual_column[at], best) << r;
        ASSERT_EQ(model.residual_value[at], errors[best]);
        errors[best] = 0;
      }
      const int64_t kept = model.first_residual[r + 1] - model.first_residual[r];
      ASSERT_LE(kept, largest);
      for (float e : errors) {
        if (kept < largest) {
          ASSERT_LE(std::abs(e), threshold);
        }
      }
    }
  }
}

TEST(Residual, NearlyLosslessIsWithinTheThreshold) {
  const Problem problem = RandomProblem(30, 40, 0.01f);
  const double threshold = 0.05;
  const ClusteredModel model =
      WithResidual(RoundToStored(problem.model), problem.truth.View(), {-1, threshold});
  std::vector<float> row(40);
  for (int64_t r = 0; r < model.rows; ++r) {
    EvaluateRow(model, r, -1, row.data());
    for (int j = 0; j < 40; ++j) EXPECT_LE(std::abs(row[j] - problem.truth.Row(r)[j]), threshold);
  }
  const ClusteredModel all =
      WithResidual(RoundToStored(problem.model), problem.truth.View(), {-1, 0});
  EXPECT_LT(RelativeError(all, problem.truth.View(), -1), 1e-6);
}

TEST(Residual, AnyRangeOfNumbersKeepsItsPrecision) {
  for (float scale : {1e-25f, 1e-6f, 1.0f, 1e6f, 1e25f}) {
    const Problem problem = RandomProblem(20, 17, scale);
    const ClusteredModel model =
        WithResidual(RoundToStored(problem.model), problem.truth.View(), {-1, 0});
    CheckModel(model);
    EXPECT_LT(RelativeError(model, problem.truth.View(), -1), 1e-6) << scale;
  }
}

TEST(Residual, MoreEntriesNeverRaiseTheErrorAndThreadsChangeNothing) {
  const Problem problem = RandomProblem(600, 31, 1);
  SetThreadCount(1);
  const ClusteredModel one = WithResidual(problem.model, problem.truth.View(), {-1, 0});
  SetThreadCount(4);
  const ClusteredModel four = WithResidual(problem.model, problem.truth.View(), {-1, 0});
  SetThreadCount(0);
  EXPECT_EQ(one.first_residual, four.first_residual);
  EXPECT_EQ(one.residual_column, four.residual_column);
  EXPECT_EQ(one.residual_value, four.residual_value);
  double before = RelativeError(one, problem.truth.View(), 0);
  for (int n = 1; n <= 31; ++n) {
    const double error = RelativeError(one, problem.truth.View(), n);
    EXPECT_LE(error, before);
    before = error;
  }
  EXPECT_EQ(before, 0);
}

TEST(Residual, SparsenessCountsEntriesOfRowsWithEnergy) {
  Problem problem = RandomProblem(3, 4, 1);
  problem.model.weights = {0, 0, 0};
  const float truth[3][4] = {{1, 0, 0.5f, 0}, {0, 0, 0, 0}, {2, 2, 2, 0.1f}};
  for (int r = 0; r < 3; ++r) std::copy_n(truth[r], 4, problem.truth.Row(r));
  EXPECT_DOUBLE_EQ(ResidualSparseness(problem.model, problem.truth.View(), 0.5), 4.0 / 8);
  EXPECT_DOUBLE_EQ(ResidualSparseness(problem.model, problem.truth.View(), 0.5, {2}), 0.25);
  EXPECT_DOUBLE_EQ(ResidualSparseness(problem.model, problem.truth.View(), 0.5, {1}), 1);
}

TEST(Residual, RefusesWhatDoesNotFit) {
  const Problem problem = RandomProblem(3, 4, 1);
  EXPECT_THROW(WithResidual(problem.model, MakeFunctionRows(3, 5).View(), {}), Error);
  EXPECT_THROW(WithResidual(problem.model, problem.truth.View(), {-2, 0}), Error);
  EXPECT_THROW(WithResidual(problem.model, problem.truth.View(), {1, -1}), Error);
  EXPECT_THROW(WithResidual(problem.model, problem.truth.View(), {1, std::nan("")}), Error);
}

TEST(StoredNumbers, RoundToTheNearestAndSaturate) {
  const StoredNumbers plain = StoredNumbersUpTo(1);
  EXPECT_EQ(plain.exponent, -14);
  EXPECT_EQ(plain.Round(1 + 0x1p-11f), 1);
  EXPECT_EQ(plain.Round(1 + 0x1.8p-10f), 1 + 0x1p-9f);
  EXPECT_EQ(plain.Round(-1e6f), -65504 * 0x1p-14f);
  const StoredNumbers large = StoredNumbersUpTo(1e25f);
  EXPECT_NEAR(large.Round(1e25f) / 1e25, 1, 0x1p-11);
  EXPECT_EQ(large.Round(large.Round(1e24f)), large.Round(1e24f));
  EXPECT_EQ(StoredNumbersUpTo(0).exponent, 0);
}

TEST(Residual, DarkRowsKeepAllTheirBits) {
  const Problem problem = RandomProblem(6, 20, 3);
  FunctionRows truth = problem.truth;
  for (int64_t r = 1; r < truth.rows; ++r) {
    for (int i = 0; i < truth.columns; ++i)
      truth.Row(r)[i] *= std::pow(0.04f, static_cast<float>(r));
  }
  ClusteredModel model = problem.model;
  std::fill(model.weights.begin(), model.weights.end(), 0.0f);
  model = WithResidual(RoundToStored(std::move(model)), truth.View(), {-1, 0});
  for (int64_t r = 0; r < truth.rows; ++r) {
    EXPECT_LT(RelativeError(model, truth.View(), -1, {r}), 0x1p-22) << r;
  }
}

}  // namespace
}  // namespace lfm
