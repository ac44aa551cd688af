// SPDX-License-Identifier: BSD-3-Clause
#include "fields/l1_optimum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/l1_linear_programme.h"
#include "fields/leading_functions.h"
#include "tests/fields/clp_oracle.h"
#include "tests/fields/l1_problems.h"

namespace lfm {
namespace {

constexpr double kGap_rel = 1e-7, kStored_rel = 1e-5;

double Magnitude(RowsView rows, int64_t row) { return ToDense(rows).row(row).cwiseAbs().sum(); }

/// That `y` proves the bound: basis y = 0 and y in its range; that the error meets it.
void ExpectCertified(RowsView basis, const L1Optimum& optimum, double magnitude,
                     ResidualSign sign) {
  const Eigen::MatrixXd functions = ToDense(basis);
  const Eigen::Map<const Eigen::VectorXd> y(optimum.dual.data(), basis.columns);
  EXPECT_LE(y.maxCoeff(), 1 + 1e-8);
  if (sign == ResidualSign::kAny) {
    EXPECT_GE(y.minCoeff(), -1 - 1e-8);
  }
  const Eigen::VectorXd product = functions * y;
  for (Eigen::Index t = 0; t < product.size(); ++t) {
    EXPECT_LE(std::abs(product[t]),
              1e-9 * functions.row(t).cwiseAbs().sum() * y.cwiseAbs().maxCoeff());
  }
  EXPECT_NEAR(optimum.error, optimum.bound, kGap_rel * magnitude);
}

TEST(L1Optimum, AgreesWithBothLinearProgrammesAndCertifiesItself) {
  const FunctionRows spiked = MakeSpikedLowRank(12, 253, 4, 0.1, 1).matrix;
  const FunctionRows reflectance = MakeReflectanceLike(12, 253, 2);
  for (const FunctionRows* targets : {&spiked, &reflectance}) {
    const FunctionRows basis = LeadingFunctions(targets->View(), 4);
    const Eigen::MatrixXd functions = ToDense(basis.View()), rows = ToDense(targets->View());
    for (int i = 0; i < targets->rows; ++i) {
      const L1Optimum optimum = FindL1Optimum(basis.View(), targets->Row(i));
      const double magnitude = Magnitude(targets->View(), i);
      ExpectCertified(basis.View(), optimum, magnitude, ResidualSign::kAny);
      EXPECT_NEAR(
          optimum.error,
          LeastErrorByClp(functions, rows.row(i), i % 2 ? ClpForm::kDual : ClpForm::kPrimal),
          kGap_rel * magnitude);
      if (i > 3) continue;
      const Eigen::VectorXd by_glpk =
          SolveLinearProgramme(functions, rows.row(i), ResidualSign::kAny).value();
      const double error =
          (rows.row(i).transpose() - functions.transpose() * by_glpk).cwiseAbs().sum();
      EXPECT_NEAR(optimum.error, error, kGap_rel * magnitude);
    }
  }
}

TEST(L1Optimum, AgreesWithTryingAllVertices) {
  for (uint32_t seed = 0; seed < 60; ++seed) {
    const int terms = 1 + static_cast<int>(seed % 3);
    const FunctionRows basis = MakeNoise(terms, 9, seed), target = MakeNoise(1, 9, 100 + seed);
    const L1Optimum optimum = FindL1Optimum(basis.View(), target.Row(0));
    ExpectCertified(basis.View(), optimum, Magnitude(target.View(), 0), ResidualSign::kAny);
    EXPECT_NEAR(optimum.error, LeastErrorByTrying(basis.View(), target.Row(0), ResidualSign::kAny),
                1e-7);
  }
}

TEST(L1Optimum, TiesDoNotTrapIt) {
  // Small whole numbers: most vertices meet more columns than they must.
  for (uint32_t seed = 0; seed < 60; ++seed) {
    FunctionRows basis = MakeNoise(3, 10, seed), target = MakeNoise(1, 10, 50 + seed);
    for (float& value : basis.values) value = std::round(1.4F * value);
    for (float& value : target.values) value = std::round(1.4F * value);
    if (!std::isfinite(LeastErrorByTrying(basis.View(), target.Row(0), ResidualSign::kAny)))
      continue;
    const L1Optimum optimum = FindL1Optimum(basis.View(), target.Row(0));
    ExpectCertified(basis.View(), optimum, 10, ResidualSign::kAny);
    EXPECT_NEAR(optimum.error, LeastErrorByTrying(basis.View(), target.Row(0), ResidualSign::kAny),
                1e-6);
  }
  // Every column a hundred times.
  FunctionRows basis = MakeFunctionRows(2, 400), target = MakeFunctionRows(1, 400);
  const FunctionRows few_basis = MakeNoise(2, 4, 7), few_target = MakeNoise(1, 4, 8);
  for (int j = 0; j < 400; ++j) {
    for (int t = 0; t < 2; ++t) basis.Row(t)[j] = few_basis.Row(t)[j % 4];
    target.Row(0)[j] = few_target.Row(0)[j % 4];
  }
  const L1Optimum optimum = FindL1Optimum(basis.View(), target.Row(0));
  EXPECT_NEAR(optimum.error,
              100 * LeastErrorByTrying(few_basis.View(), few_target.Row(0), ResidualSign::kAny),
              1e-4);
}

TEST(L1Optimum, PositiveResidualsAgreeWithTryingAllVertices) {
  int feasible = 0;
  for (uint32_t seed = 0; seed < 80; ++seed) {
    const int terms = 1 + static_cast<int>(seed % 3);
    FunctionRows basis = MakeNoise(terms, 9, seed), target = MakeNoise(1, 9, 100 + seed);
    // Half of the targets without negative numbers, where zero weights will do.
    for (float& value : target.values) value += seed % 2 ? 1.0F : 0.3F;
    const double least = LeastErrorByTrying(basis.View(), target.Row(0), ResidualSign::kPositive);
    if (!std::isfinite(least)) {
      EXPECT_THROW(FindL1Optimum(basis.View(), target.Row(0), ResidualSign::kPositive), Error);
      continue;
    }
    ++feasible;
    const L1Optimum optimum = FindL1Optimum(basis.View(), target.Row(0), ResidualSign::kPositive);
    ExpectCertified(basis.View(), optimum, 20, ResidualSign::kPositive);
    EXPECT_NEAR(optimum.error, least, 1e-6) << seed;
  }
  EXPECT_GT(feasible, 45);
}

TEST(L1Optimum, PositiveResidualsAgreeWithTheLinearProgramme) {
  const FunctionRows targets = MakeReflectanceLike(6, 253, 3);
  const FunctionRows basis = LeadingFunctions(targets.View(), 4);
  const Eigen::MatrixXd functions = ToDense(basis.View()), rows = ToDense(targets.View());
  L1Options options;
  options.sign = ResidualSign::kPositive;
  const L1Solution found = SolveL1(basis.View(), targets.View(), options);
  options.solver = L1Solver::kLinearProgramme;
  const L1Solution by_programme = SolveL1(basis.View(), targets.View(), options);
  for (int i = 0; i < 6; ++i) {
    const double magnitude = Magnitude(targets.View(), i);
    EXPECT_NEAR(found.errors[i], by_programme.errors[i], 1e-6 * magnitude);
    const Eigen::Map<const Eigen::Vector4f> weights(found.weights.data() + 4 * i);
    const Eigen::VectorXd rest =
        rows.row(i).transpose() - functions.transpose() * weights.cast<double>();
    EXPECT_GE(rest.minCoeff(), -1e-6 * magnitude / 253);
    ExpectCertified(basis.View(),
                    FindL1Optimum(basis.View(), targets.Row(i), ResidualSign::kPositive), magnitude,
                    ResidualSign::kPositive);
  }
}

TEST(L1Optimum, SolversAgreeAndTheirNumbersAreTheSameOnAnyNumberOfThreads) {
  const SpikedLowRank problem = MakeSpikedLowRank(24, 60, 3, 0.3, 4);
  std::vector<std::vector<double>> errors;
  for (const L1Solver solver : {L1Solver::kExact, L1Solver::kLinearProgramme}) {
    L1Options options;
    options.solver = solver;
    SetThreadCount(1);
    const L1Solution one = SolveL1(problem.basis.View(), problem.matrix.View(), options);
    SetThreadCount(3);
    const L1Solution three = SolveL1(problem.basis.View(), problem.matrix.View(), options);
    SetThreadCount(0);
    EXPECT_EQ(one.weights, three.weights);
    errors.push_back(one.errors);
  }
  for (size_t i = 0; i < errors[0].size(); ++i) {
    const L1Optimum optimum =
        FindL1Optimum(problem.basis.View(), problem.matrix.Row(static_cast<int64_t>(i)));
    EXPECT_NEAR(errors[0][i], optimum.error, kStored_rel * optimum.error);
    EXPECT_NEAR(errors[1][i], optimum.error, kStored_rel * optimum.error);
  }
}

TEST(L1Optimum, Extremes) {
  const FunctionRows noise = MakeNoise(4, 12, 5), black = MakeFunctionRows(2, 12);
  for (const L1Solver solver :
       {L1Solver::kExact, L1Solver::kLinearProgramme, L1Solver::kQuadraticProgramme}) {
    L1Options options;
    options.solver = solver;
    for (float weight : SolveL1(noise.View(), black.View(), options).weights) EXPECT_EQ(weight, 0);
    for (float weight : SolveL1(black.View(), noise.View(), options).weights) EXPECT_EQ(weight, 0);
    const FunctionRows few = MakeNoise(5, 3, 6), targets = MakeNoise(8, 3, 7);
    for (double error : SolveL1(few.View(), targets.View(), options).errors) EXPECT_LT(error, 1e-5);
    for (float scale : {1e-25F, 1e25F}) {
      FunctionRows scaled = noise;
      for (float& value : scaled.values) value *= scale;
      const FunctionRows basis = GatherRows(noise.View(), {0, 1});
      const double plain = SolveL1(basis.View(), noise.View(), options).errors[2];
      EXPECT_NEAR(SolveL1(basis.View(), scaled.View(), options).errors[2] / scale, plain,
                  1e-5 * plain);
    }
  }
  const L1Optimum dark = FindL1Optimum(noise.View(), black.Row(0));
  EXPECT_EQ(dark.error, 0);
  const L1Optimum without = FindL1Optimum(black.View(), noise.Row(0));
  EXPECT_NEAR(without.bound, Magnitude(noise.View(), 0), 1e-6);
}

TEST(L1Optimum, APositiveResidualMayBeImpossible) {
  FunctionRows basis = MakeFunctionRows(1, 2), target = MakeFunctionRows(1, 2);
  basis.Row(0)[0] = 1;
  basis.Row(0)[1] = -1;
  target.Row(0)[0] = target.Row(0)[1] = -1;  // x <= -1 and -x <= -1
  EXPECT_THROW(FindL1Optimum(basis.View(), target.Row(0), ResidualSign::kPositive), Error);
  for (const L1Solver solver : {L1Solver::kReweighted, L1Solver::kLinearProgramme}) {
    L1Options options;
    options.solver = solver;
    options.sign = ResidualSign::kPositive;
    EXPECT_THROW(SolveL1(basis.View(), target.View(), options), Error);
  }
  target.Row(0)[1] = 3;  // -3 <= x <= -1
  const L1Optimum optimum = FindL1Optimum(basis.View(), target.Row(0), ResidualSign::kPositive);
  EXPECT_NEAR(optimum.error, 2, 1e-7);
}

}  // namespace
}  // namespace lfm
