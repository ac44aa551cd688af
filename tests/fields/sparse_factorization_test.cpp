// SPDX-License-Identifier: BSD-3-Clause
#include "fields/sparse_factorization.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/parallel.h"
#include "tests/fields/l1_problems.h"

namespace lfm {
namespace {

Eigen::MatrixXd Residual(RowsView matrix, const SparseFactors& factors) {
  Eigen::MatrixXd rest = ToDense(matrix);
  const int64_t terms = factors.basis.rows;
  for (int64_t i = 0; i < matrix.rows; ++i) {
    for (int64_t t = 0; t < terms; ++t) {
      for (int j = 0; j < matrix.columns; ++j) {
        rest(i, j) -= double{factors.weights[i * terms + t]} * factors.basis.Row(t)[j];
      }
    }
  }
  return rest;
}

double SmallPart(const Eigen::MatrixXd& rest, double threshold) {
  return static_cast<double>((rest.cwiseAbs().array() < threshold).count()) /
         static_cast<double>(rest.size());
}

/// Sizes fit, functions have unit length, the error never rises and is what is reported.
void ExpectSound(RowsView matrix, const SparseFactors& factors) {
  ASSERT_EQ(static_cast<int64_t>(factors.weights.size()), matrix.rows * factors.basis.rows);
  for (int64_t t = 0; t < factors.basis.rows; ++t) {
    EXPECT_NEAR(ToDense(factors.basis.View()).row(t).norm(), 1, 1e-5);
  }
  ASSERT_FALSE(factors.l1_error.empty());
  for (size_t i = 1; i < factors.l1_error.size(); ++i) {
    EXPECT_LT(factors.l1_error[i], factors.l1_error[i - 1]);
  }
  const double error = Residual(matrix, factors).cwiseAbs().sum();
  EXPECT_TRUE(std::isfinite(error));
  EXPECT_NEAR(factors.l1_error.back(), error, 1e-9 * ToDense(matrix).cwiseAbs().sum());
}

SparseFactors Factorize(RowsView matrix, int terms, FactorStart start = FactorStart::kPca) {
  SparseFactorizationOptions options;
  options.terms = terms;
  options.start = start;
  return FactorizeSparse(matrix, options);
}

TEST(SparseFactorization, FindsTheSparseResidualOfALowRankMatrixFromEitherStart) {
  const SpikedLowRank problem = MakeSpikedLowRank(150, 100, 4, 0.1, 1);
  const double spikes = 0.1 * 150 * 100 * 0.5;
  for (const FactorStart start : {FactorStart::kPca, FactorStart::kRandom}) {
    const SparseFactors factors = Factorize(problem.matrix.View(), 4, start);
    ExpectSound(problem.matrix.View(), factors);
    EXPECT_LE(factors.l1_error.size(), 11u) << "ten alternations, the paper's count";
    EXPECT_NEAR(factors.l1_error.back(), spikes, 0.1 * spikes);
    EXPECT_GE(SmallPart(Residual(problem.matrix.View(), factors), 1e-3), 0.89);
  }
}

TEST(SparseFactorization, ResidualsOfReflectanceAreSparserThanThoseOfPca) {
  const FunctionRows matrix = MakeReflectanceLike(120, 100, 2);
  SparseFactorizationOptions options;
  options.max_alternations = 0;
  const SparseFactors pca = FactorizeSparse(matrix.View(), options);
  const SparseFactors factors = Factorize(matrix.View(), 4);
  ExpectSound(matrix.View(), factors);
  EXPECT_LT(factors.l1_error.back(), 0.98 * pca.l1_error.back());
  EXPECT_GT(SmallPart(Residual(matrix.View(), factors), 2e-3),
            SmallPart(Residual(matrix.View(), pca), 2e-3));
}

TEST(SparseFactorization, EverySolverLeadsToTheSameError) {
  const SpikedLowRank problem = MakeSpikedLowRank(30, 25, 2, 0.1, 3);
  SparseFactorizationOptions options;
  options.terms = 2;
  const double expected = FactorizeSparse(problem.matrix.View(), options).l1_error.back();
  for (const L1Solver solver :
       {L1Solver::kExact, L1Solver::kLinearProgramme, L1Solver::kQuadraticProgramme}) {
    options.l1.solver = solver;
    const SparseFactors factors = FactorizeSparse(problem.matrix.View(), options);
    ExpectSound(problem.matrix.View(), factors);
    EXPECT_NEAR(factors.l1_error.back(), expected, 0.02 * expected);
  }
}

TEST(SparseFactorization, PositiveResiduals) {
  const FunctionRows matrix = MakeReflectanceLike(40, 30, 4);
  SparseFactorizationOptions options;
  options.terms = 2;
  options.l1.sign = ResidualSign::kPositive;
  for (const FactorStart start : {FactorStart::kPca, FactorStart::kRandom}) {
    options.start = start;
    const SparseFactors factors = FactorizeSparse(matrix.View(), options);
    ExpectSound(matrix.View(), factors);
    EXPECT_GE(Residual(matrix.View(), factors).minCoeff(), -1e-5);
    EXPECT_GT(factors.l1_error.size(), 1u);
  }
}

TEST(SparseFactorization, DoesNotDependOnTheNumberOfThreads) {
  const FunctionRows matrix = MakeReflectanceLike(150, 40, 5);
  SetThreadCount(1);
  const SparseFactors one = Factorize(matrix.View(), 3);
  SetThreadCount(3);
  const SparseFactors three = Factorize(matrix.View(), 3);
  SetThreadCount(0);
  EXPECT_EQ(one.basis.values, three.basis.values);
  EXPECT_EQ(one.weights, three.weights);
  EXPECT_EQ(one.l1_error, three.l1_error);
}

TEST(SparseFactorization, Extremes) {
  for (const FactorStart start : {FactorStart::kPca, FactorStart::kRandom}) {
    const FunctionRows black = MakeFunctionRows(5, 7);
    const SparseFactors nothing = Factorize(black.View(), 3, start);
    ExpectSound(black.View(), nothing);
    EXPECT_EQ(nothing.basis.rows, 0);
    EXPECT_EQ(nothing.l1_error.back(), 0);

    const FunctionRows row = MakeNoise(1, 9, 6), column = MakeNoise(9, 1, 7);
    for (const FunctionRows* matrix : {&row, &column}) {
      const SparseFactors factors = Factorize(matrix->View(), 4, start);
      ExpectSound(matrix->View(), factors);
      EXPECT_EQ(factors.basis.rows, 1);
      EXPECT_LT(factors.l1_error.back(), 1e-5);
    }

    const FunctionRows small = MakeNoise(3, 8, 8);
    const SparseFactors cut = Factorize(small.View(), 9, start);
    ExpectSound(small.View(), cut);
    EXPECT_EQ(cut.basis.rows, 3);
    EXPECT_LT(cut.l1_error.back(), 1e-3);

    FunctionRows equal = MakeFunctionRows(20, 6);
    for (int i = 0; i < 20; ++i) std::fill_n(equal.Row(i), 6, 0.7F);
    ExpectSound(equal.View(), Factorize(equal.View(), 2, start));
    EXPECT_LT(Factorize(equal.View(), 2, start).l1_error.back(), 1e-4);
    const FunctionRows repeated = GatherRows(small.View(), {0, 0, 0, 1, 1, 0, 1, 0, 1, 0, 0, 1});
    ExpectSound(repeated.View(), Factorize(repeated.View(), 4, start));
    EXPECT_LT(Factorize(repeated.View(), 4, start).l1_error.back(), 1e-3);
    if (start == FactorStart::kPca) {
      EXPECT_EQ(Factorize(repeated.View(), 4).basis.rows, 2);
    }
    const FunctionRows none = MakeFunctionRows(0, 4);
    ExpectSound(none.View(), Factorize(none.View(), 2, start));
  }
}

TEST(SparseFactorization, MagnitudesMayLieAnywhere) {
  const SpikedLowRank problem = MakeSpikedLowRank(30, 20, 2, 0.1, 9);
  const double plain = Factorize(problem.matrix.View(), 2).l1_error.back();
  for (const float scale : {1e-25F, 1e25F}) {
    FunctionRows scaled = problem.matrix;
    for (float& value : scaled.values) value *= scale;
    const SparseFactors factors = Factorize(scaled.View(), 2);
    ExpectSound(scaled.View(), factors);
    EXPECT_NEAR(factors.l1_error.back() / scale, plain, 0.01 * plain);
  }
}

TEST(SparseFactorization, RejectsWhatIsOutOfRange) {
  FunctionRows matrix = MakeNoise(4, 4, 10);
  EXPECT_THROW(Factorize(matrix.View(), -1), Error);
  EXPECT_THROW(Factorize(matrix.View(), 17), Error);
  EXPECT_EQ(Factorize(matrix.View(), 0).basis.rows, 0);
  matrix.Row(1)[2] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(Factorize(matrix.View(), 2), Error);
}

}  // namespace
}  // namespace lfm
