// SPDX-License-Identifier: BSD-3-Clause
#include "fields/l1_reweighted.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/leading_functions.h"
#include "tests/fields/clp_oracle.h"
#include "tests/fields/l1_problems.h"

namespace lfm {
namespace {

constexpr double kObjective_rel = 1e-3, kStored_rel = 1e-12;

double Sum(const std::vector<double>& errors) {
  return std::accumulate(errors.begin(), errors.end(), 0.0);
}

double LeastError(RowsView basis, RowsView targets) {
  const Eigen::MatrixXd functions = ToDense(basis), rows = ToDense(targets);
  double sum = 0;
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    sum += LeastErrorByClp(functions, rows.row(i), ClpForm::kDual);
  }
  return sum;
}

FunctionRows Scaled(FunctionRows rows, float factor) {
  for (float& value : rows.values) value *= factor;
  return rows;
}

std::vector<kernels::L1Level> LevelsHere() {
  std::vector<kernels::L1Level> levels;
  for (const auto level :
       {kernels::L1Level::kBaseline, kernels::L1Level::kAvx2, kernels::L1Level::kAvx512}) {
    if (kernels::HasL1Level(level)) levels.push_back(level);
  }
  return levels;
}

TEST(L1Reweighted, EveryInstructionSetComesWithinATenthOfAPercent) {
  const FunctionRows spiked = MakeSpikedLowRank(40, 253, 4, 0.1, 1).matrix;
  const FunctionRows reflectance = MakeReflectanceLike(40, 253, 2);
  for (const FunctionRows* targets : {&spiked, &reflectance}) {
    const FunctionRows basis = LeadingFunctions(targets->View(), 4);
    const double least = LeastError(basis.View(), targets->View());
    for (const auto level : LevelsHere()) {
      const L1Solution found =
          SolveReweighted(basis.View(), targets->View(), 20, {}, kernels::L1KernelsOf(level));
      EXPECT_LE(Sum(found.errors), least * (1 + kObjective_rel)) << static_cast<int>(level);
      EXPECT_GE(Sum(found.errors), least * (1 - 1e-7));
      EXPECT_NEAR(Sum(found.errors), L1Error(basis.View(), found.weights, targets->View()),
                  kStored_rel * least);
    }
  }
}

TEST(L1Reweighted, EveryNumberOfFunctions) {
  for (int terms = 1; terms <= 16; ++terms) {
    const SpikedLowRank problem = MakeSpikedLowRank(9, 80, terms, 0.1, 3);
    const double least = LeastError(problem.basis.View(), problem.matrix.View());
    for (const auto level : LevelsHere()) {
      const L1Solution found = SolveReweighted(problem.basis.View(), problem.matrix.View(), 20, {},
                                               kernels::L1KernelsOf(level));
      EXPECT_LE(Sum(found.errors), least * (1 + kObjective_rel)) << terms << " functions";
    }
  }
}

TEST(L1Reweighted, OneConstantFunctionFindsTheMedian) {
  FunctionRows basis = MakeFunctionRows(1, 5), targets = MakeFunctionRows(1, 5);
  std::fill_n(basis.Row(0), 5, 2.0F);
  std::copy_n(std::vector<float>{1, 2, 4, 90, 1000}.begin(), 5, targets.Row(0));
  const L1Solution found = SolveL1(basis.View(), targets.View(), {});
  EXPECT_NEAR(found.weights[0], 2, 1e-3);
  EXPECT_NEAR(found.errors[0], 1087, 1e-2);
}

TEST(L1Reweighted, IsNeverWorseThanItsStart) {
  const SpikedLowRank problem = MakeSpikedLowRank(50, 60, 4, 0.3, 4);
  L1Options options;
  options.solver = L1Solver::kExact;
  const L1Solution best = SolveL1(problem.basis.View(), problem.matrix.View(), options);
  const L1Solution after = SolveL1(problem.basis.View(), problem.matrix.View(), {}, best.weights);
  for (size_t i = 0; i < after.errors.size(); ++i) {
    EXPECT_LE(after.errors[i], best.errors[i] * (1 + kStored_rel));
  }
  // Not even without an iteration, or from far away.
  options = {};
  options.iterations = 0;
  std::vector<float> far(best.weights.size(), 1e6F);
  const L1Solution near = SolveL1(problem.basis.View(), problem.matrix.View(), {}, far);
  EXPECT_LE(Sum(near.errors), 2 * Sum(best.errors));
  const L1Solution still = SolveL1(problem.basis.View(), problem.matrix.View(), options, far);
  EXPECT_LE(Sum(still.errors), L1Error(problem.basis.View(), far, problem.matrix.View()));
}

TEST(L1Reweighted, AnAbsurdStartDoesNoHarm) {
  const SpikedLowRank problem = MakeSpikedLowRank(10, 60, 4, 0.1, 4);
  const double plain = Sum(SolveL1(problem.basis.View(), problem.matrix.View(), {}).errors);
  const std::vector<float> absurd(40, 1e38F);
  const L1Solution found = SolveL1(problem.basis.View(), problem.matrix.View(), {}, absurd);
  EXPECT_NEAR(Sum(found.errors), plain, 0.01 * plain);
}

TEST(L1Reweighted, AStartNearbySavesIterations) {
  const FunctionRows targets = MakeReflectanceLike(40, 253, 5);
  const FunctionRows basis = LeadingFunctions(targets.View(), 4);
  L1Options options;
  const L1Solution before = SolveL1(basis.View(), targets.View(), options);
  options.iterations = 5;
  const double cold = Sum(SolveL1(basis.View(), targets.View(), options).errors);
  const double warm = Sum(SolveL1(basis.View(), targets.View(), options, before.weights).errors);
  EXPECT_LE(warm, Sum(before.errors));
  EXPECT_LT(warm, cold);
}

TEST(L1Reweighted, ThreadsAndNeighboursDoNotMatter) {
  const SpikedLowRank problem = MakeSpikedLowRank(333, 70, 3, 0.2, 6);
  SetThreadCount(1);
  const L1Solution one = SolveL1(problem.basis.View(), problem.matrix.View(), {});
  SetThreadCount(3);
  const L1Solution three = SolveL1(problem.basis.View(), problem.matrix.View(), {});
  SetThreadCount(0);
  EXPECT_EQ(one.weights, three.weights);
  EXPECT_EQ(one.errors, three.errors);
  for (int64_t row : {0, 5, 332}) {
    const FunctionRows alone = GatherRows(problem.matrix.View(), {row});
    const L1Solution found = SolveL1(problem.basis.View(), alone.View(), {});
    for (int t = 0; t < 3; ++t) EXPECT_EQ(found.weights[t], one.weights[row * 3 + t]);
  }
}

TEST(L1Reweighted, MagnitudesMayLieAnywhere) {
  const SpikedLowRank problem = MakeSpikedLowRank(20, 50, 3, 0.2, 7);
  const double plain = Sum(SolveL1(problem.basis.View(), problem.matrix.View(), {}).errors);
  for (float of_targets : {1e-25F, 1e25F}) {
    for (float of_basis : {1e-10F, 1.0F, 1e10F}) {
      const FunctionRows targets = Scaled(problem.matrix, of_targets);
      const FunctionRows basis = Scaled(problem.basis, of_basis);
      const double found = Sum(SolveL1(basis.View(), targets.View(), {}).errors);
      EXPECT_NEAR(found / of_targets, plain, plain * 1e-4) << of_targets << " " << of_basis;
    }
  }
  EXPECT_THROW(
      SolveL1(Scaled(problem.basis, 1e-25F).View(), Scaled(problem.matrix, 1e25F).View(), {}),
      Error);
}

TEST(L1Reweighted, FunctionsMayDependOnEachOther) {
  const SpikedLowRank problem = MakeSpikedLowRank(20, 50, 3, 0.2, 8);
  FunctionRows basis = MakeFunctionRows(6, 50);  // zero, twice the same, a sum
  for (int j = 0; j < 50; ++j) {
    const float a = problem.basis.Row(0)[j], b = problem.basis.Row(1)[j];
    const float values[] = {0, a, b, a, 0.3F * a + 0.7F * b, problem.basis.Row(2)[j]};
    for (int t = 0; t < 6; ++t) basis.Row(t)[j] = values[t];
  }
  const double plain = Sum(SolveL1(problem.basis.View(), problem.matrix.View(), {}).errors);
  const L1Solution found = SolveL1(basis.View(), problem.matrix.View(), {});
  EXPECT_NEAR(Sum(found.errors), plain, 1e-4 * plain);
  for (float weight : found.weights) EXPECT_LT(std::abs(weight), 100) << "weights that cancel";
}

TEST(L1Reweighted, Extremes) {
  const FunctionRows noise = MakeNoise(3, 20, 9);
  const FunctionRows black = MakeFunctionRows(5, 20);
  for (float weight : SolveL1(noise.View(), black.View(), {}).weights) EXPECT_EQ(weight, 0);
  const L1Solution without = SolveL1(black.View(), noise.View(), {});
  for (float weight : without.weights) EXPECT_EQ(weight, 0);
  EXPECT_NEAR(without.errors[1], ToDense(noise.View()).row(1).cwiseAbs().sum(), 1e-9);
  const FunctionRows none = MakeFunctionRows(0, 20);
  EXPECT_EQ(SolveL1(none.View(), noise.View(), {}).errors, without.errors);
  EXPECT_TRUE(SolveL1(noise.View(), none.View(), {}).weights.empty());
  // Fewer columns than functions: all can be met.
  const FunctionRows few = MakeNoise(5, 3, 10), targets = MakeNoise(40, 3, 11);
  for (double error : SolveL1(few.View(), targets.View(), {}).errors) EXPECT_LT(error, 1e-5);
  const FunctionRows narrow = MakeNoise(2, 1, 12), single = MakeNoise(7, 1, 13);
  for (double error : SolveL1(narrow.View(), single.View(), {}).errors) EXPECT_LT(error, 1e-6);
}

TEST(L1Reweighted, ARangeOfAMillionInOneRow) {
  SpikedLowRank problem = MakeSpikedLowRank(20, 100, 2, 0, 14);
  for (int i = 0; i < 20; ++i) problem.matrix.Row(i)[i] = 1e6F;
  const L1Solution found = SolveL1(problem.basis.View(), problem.matrix.View(), {});
  const double least = LeastError(problem.basis.View(), problem.matrix.View());
  EXPECT_LE(Sum(found.errors), least * (1 + 1e-4));
}

TEST(L1Reweighted, RejectsWhatDoesNotFit) {
  const FunctionRows basis = MakeNoise(2, 10, 15);
  FunctionRows targets = MakeNoise(3, 10, 16);
  EXPECT_THROW(SolveL1(basis.View(), MakeNoise(3, 9, 1).View(), {}), Error);
  EXPECT_THROW(SolveL1(MakeNoise(17, 10, 1).View(), targets.View(), {}), Error);
  EXPECT_THROW(SolveL1(basis.View(), targets.View(), {}, {1, 2, 3}), Error);
  L1Options options;
  options.iterations = -1;
  EXPECT_THROW(SolveL1(basis.View(), targets.View(), options), Error);
  const float bad = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(SolveL1(basis.View(), targets.View(), {}, {1, 2, bad, 0, 0, 0}), Error);
  targets.Row(2)[4] = std::numeric_limits<float>::infinity();
  for (const L1Solver solver : {L1Solver::kReweighted, L1Solver::kExact}) {
    L1Options either;
    either.solver = solver;
    EXPECT_THROW(SolveL1(basis.View(), targets.View(), either), Error);
    EXPECT_THROW(SolveL1(targets.View(), basis.View(), either), Error);
  }
}

}  // namespace
}  // namespace lfm
