// SPDX-License-Identifier: BSD-3-Clause
#include "encode/paper_factorization.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "tests/encode/dense_oracle.h"

namespace lfm::testing {
namespace {

TEST(PaperPca, FindsTheSingularValuesAndTheBestApproximation) {
  const Eigen::VectorXd values = Eigen::VectorXd::NullaryExpr(
      20, [](Eigen::Index i) { return std::pow(2.0, -static_cast<double>(i)); });
  const Eigen::MatrixXd f = MatrixWithSpectrum(80, 50, values, 1);
  const auto factors = PaperPca<double>(f, {.terms = 5, .tolerance = 1e-10});
  ASSERT_EQ(factors.left.cols(), 5);
  for (int k = 0; k < 5; ++k) EXPECT_NEAR(factors.singular_values[k], values[k], 1e-9) << k;
  EXPECT_NEAR((f - factors.left * factors.right.transpose()).norm(), values.tail(15).norm(), 1e-9);
  const auto single = PaperPca<float>(f.cast<float>(), {.terms = 5});
  for (int k = 0; k < 5; ++k) EXPECT_NEAR(single.singular_values[k], values[k], 1e-5) << k;
}

// After the split both maxima are sqrt(lambda max_u max_v).
TEST(PaperPca, SplitsLambdaByAlpha) {
  const Eigen::MatrixXd f = RandomNormal(40, 30, 3);
  const auto factors = PaperPca<double>(f, {.terms = 2});
  for (int k = 0; k < 2; ++k) {
    const Eigen::VectorXd u = factors.left.col(k), v = factors.right.col(k);
    EXPECT_NEAR(u.norm() * v.norm(), factors.singular_values[k], 1e-9);
    const double both =
        std::sqrt(factors.singular_values[k] * u.normalized().cwiseAbs().maxCoeff() *
                  v.normalized().cwiseAbs().maxCoeff());
    EXPECT_NEAR(u.cwiseAbs().maxCoeff(), both, 1e-9);
    EXPECT_NEAR(v.cwiseAbs().maxCoeff(), both, 1e-9);
  }
}

TEST(PaperPca, EndsWhereNothingIsLeftAndForRepeatedValues) {
  EXPECT_EQ(PaperPca<double>(Eigen::MatrixXd::Zero(5, 4), {}).left.cols(), 0);
  EXPECT_EQ(PaperPca<double>(RandomNormal(5, 1, 4) * RandomNormal(1, 4, 5), {}).left.cols(), 1);
  EXPECT_EQ(PaperPca<double>(Eigen::MatrixXd(0, 4), {}).left.cols(), 0);
  EXPECT_EQ(PaperPca<double>(RandomNormal(5, 4, 6), {.terms = 0}).left.cols(), 0);
  const Eigen::MatrixXd f = MatrixWithSpectrum(80, 50, Eigen::VectorXd::Ones(6), 7);
  const auto factors = PaperPca<double>(f, {.terms = 6, .max_iterations = 500});
  EXPECT_LE((f - factors.left * factors.right.transpose()).norm(), 1e-6);
  for (const int iterations : factors.iterations) EXPECT_LE(iterations, 500);
}

TEST(PaperNmf, NeverRaisesTheErrorAndSumsToOne) {
  const Eigen::MatrixXd f = RandomNormal(40, 30, 8).cwiseAbs();
  double before = f.norm();
  for (const int iterations : {1, 2, 5, 20, 100, 400}) {
    const auto factors =
        PaperNmf<double>(f, {.terms = 4, .tolerance = 0, .max_iterations = iterations});
    const double error = (f - factors.left * factors.right.transpose()).norm();
    EXPECT_LE(error, before * (1 + 1e-12)) << iterations;
    before = error;
    EXPECT_GE(factors.left.minCoeff(), 0);
    EXPECT_GE(factors.right.minCoeff(), 0);
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(factors.left.col(k).sum(), 1, 1e-9);
  }
}

TEST(PaperFactorization, RefusesWhatItCannotDo) {
  Eigen::MatrixXd f = RandomNormal(5, 4, 9);
  EXPECT_THROW(PaperNmf<double>(f, {}), Error);
  EXPECT_EQ(PaperNmf<double>(Eigen::MatrixXd::Zero(5, 4), {}).left.cols(), 0);
  f(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(PaperPca<double>(f, {}), Error);
  EXPECT_THROW(PaperNmf<double>(f, {}), Error);
}

}  // namespace
}  // namespace lfm::testing
