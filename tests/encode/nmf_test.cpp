// SPDX-License-Identifier: BSD-3-Clause
#include "encode/nmf.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/error.h"
#include "encode/paper_factorization.h"
#include "tests/encode/dense_oracle.h"

namespace lfm::testing {
namespace {

Eigen::MatrixXd RandomPositive(int rows, int cols, int seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform;
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return uniform(random); });
}

// Lobes of several widths on textured samples: what a vertex light field looks like.
Eigen::MatrixXd Lobes(int rows, int cols) {
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&](Eigen::Index row, Eigen::Index col) {
    const double s = static_cast<double>(row) / rows, t = static_cast<double>(col) / cols;
    const double narrow = std::exp(-200 * std::pow(t - 0.3 - 0.2 * s, 2));
    const double wide = std::exp(-20 * std::pow(t - 0.7, 2));
    return 0.3 + 0.2 * std::sin(9 * s) + 0.5 * (1 - s) * narrow +
           0.3 * wide * (1 + std::cos(40 * s));
  });
}

struct Outcome {
  NmfResult nmf;
  double error = 0, norm = 0;  // ||F - U V^T|| and ||F||, of the largest entry
  double unit = 1;             // the largest entry
};

Outcome Factorise(const Eigen::MatrixXd& f_double, const NmfOptions& options) {
  const RowMatrix f = f_double.cast<float>();
  const Eigen::MatrixXd exact = f.cast<double>();
  Outcome outcome;
  outcome.nmf = ComputeNmf(DenseMap(f), options);
  const NmfResult& r = outcome.nmf;
  const int rows = static_cast<int>(f.rows()), cols = static_cast<int>(f.cols());
  const Eigen::MatrixXd u =
      Eigen::Map<const RowMatrix>(r.left.data(), rows, r.width).cast<double>();
  const Eigen::MatrixXd v =
      Eigen::Map<const RowMatrix>(r.right.data(), cols, r.width).cast<double>();
  const double unit =
      exact.size() > 0 && exact.cwiseAbs().maxCoeff() > 0 ? exact.cwiseAbs().maxCoeff() : 1;
  outcome.error = (exact / unit - u * (v / unit).transpose()).norm();
  outcome.norm = (exact / unit).norm();
  EXPECT_GE(u.minCoeff(), 0);
  EXPECT_GE(v.minCoeff(), 0);
  for (int k = 0; k < r.width; ++k) {
    EXPECT_NEAR(u.col(k).sum(), k < r.terms ? 1 : 0, 1e-5) << k;
    if (k >= r.terms) {
      EXPECT_EQ(v.col(k).norm(), 0) << k;
    }
  }
  const double fall = r.squared_error_fall / unit / unit;
  EXPECT_NEAR(outcome.norm * outcome.norm - fall, outcome.error * outcome.error,
              2e-5 * outcome.norm * outcome.norm);
  outcome.unit = unit;
  return outcome;
}

double AbsoluteError(const Eigen::MatrixXd& f, int terms) {
  const Outcome found = Factorise(f, {.terms = terms});
  return found.error * found.unit;
}

double PaperError(const Eigen::MatrixXd& f, int terms) {
  const auto factors =
      PaperNmf<double>(f, {.terms = terms, .tolerance = 1e-7, .max_iterations = 5000});
  return (f - factors.left * factors.right.transpose()).norm();
}

TEST(Nmf, FindsExactNonnegativeFactors) {
  for (const int rank : {1, 2, 3}) {
    const Eigen::MatrixXd f =
        RandomPositive(200, rank, 1) * RandomPositive(90, rank, 2).transpose();
    const Outcome found = Factorise(f, {.terms = 3, .tolerance = 1e-9, .max_iterations = 2000});
    EXPECT_LE(found.error, 5e-3 * found.norm) << rank;
  }
}

TEST(Nmf, IsNoWorseThanMultiplicativeUpdatesRunToConvergence) {
  for (const int terms : {1, 2, 3, 5}) {
    const Eigen::MatrixXd lobes = Lobes(300, 150);
    EXPECT_LE(AbsoluteError(lobes, terms), 1.1 * PaperError(lobes, terms)) << terms;
    const Eigen::MatrixXd noisy = lobes + 0.1 * RandomPositive(300, 150, 3);
    EXPECT_LE(AbsoluteError(noisy, terms), 1.1 * PaperError(noisy, terms)) << terms;
  }
}

TEST(Nmf, IsNoBetterThanPcaAndOneTermIsPca) {
  const Eigen::MatrixXd f = Lobes(300, 150);
  const Eigen::VectorXd values = SingularValues(f);
  for (const int terms : {1, 3, 8}) {
    const double best = values.tail(values.size() - terms).norm();
    const double error = AbsoluteError(f, terms);
    EXPECT_GE(error, best * (1 - 1e-4)) << terms;
    // Perron: the leading pair of a nonnegative matrix is nonnegative.
    if (terms == 1) {
      EXPECT_LE(error, best * (1 + 1e-4));
    }
  }
}

TEST(Nmf, TermsAreInTheOrderOfTheirEnergy) {
  const Outcome found = Factorise(Lobes(300, 150), {.terms = 5});
  const NmfResult& r = found.nmf;
  const Eigen::MatrixXf u = Eigen::Map<const RowMatrix>(r.left.data(), 300, r.width);
  const Eigen::MatrixXf v = Eigen::Map<const RowMatrix>(r.right.data(), 150, r.width);
  for (int k = 1; k < r.terms; ++k) {
    EXPECT_GE(u.col(k - 1).norm() * v.col(k - 1).norm(), u.col(k).norm() * v.col(k).norm()) << k;
  }
}

TEST(Nmf, HoldsAtTheExtremes) {
  EXPECT_EQ(Factorise(Eigen::MatrixXd::Zero(30, 20), {.terms = 3}).nmf.terms, 0);
  EXPECT_EQ(Factorise(Lobes(30, 20), {.terms = 0}).nmf.terms, 0);
  EXPECT_EQ(Factorise(Eigen::MatrixXd::Constant(30, 20, 0.7), {.terms = 3}).nmf.terms, 1);
  EXPECT_LE(Factorise(RandomPositive(1, 20, 4), {.terms = 3}).error, 1e-5);
  EXPECT_LE(Factorise(RandomPositive(30, 1, 5), {.terms = 3}).error, 1e-5);
  EXPECT_LE(Factorise(RandomPositive(3, 3, 6), {.terms = 16}).error, 1e-3);
  const Eigen::MatrixXd f = Lobes(60, 40);
  const double usual = Factorise(f, {.terms = 3}).error;
  for (const double scale : {1e-25, 1e-6, 1e6, 1e25}) {
    EXPECT_NEAR(Factorise(scale * f, {.terms = 3}).error, usual, 1e-3 * usual) << scale;
  }
}

// Nothing nonnegative comes nearer to a negative matrix than zero.
TEST(Nmf, NegativeEntriesAreDataToo) {
  const Outcome found = Factorise(-Lobes(60, 40), {.terms = 3});
  EXPECT_NEAR(found.error, found.norm, 1e-5 * found.norm);
  Eigen::MatrixXd some = Lobes(60, 40);
  some.topRows(5).array() -= 1;
  EXPECT_LT(Factorise(some, {.terms = 3}).error, 0.6 * Factorise(some, {.terms = 3}).norm);
}

TEST(Nmf, RejectsWhatIsNotFinite) {
  RowMatrix f = RowMatrix::Ones(30, 20);
  f(3, 4) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(ComputeNmf(DenseMap(f), {.terms = 3}), Error);
  f(3, 4) = 1;
  EXPECT_THROW(ComputeNmf(DenseMap(f), {.terms = 17}), Error);
}

TEST(Nmf, RepeatsItself) {
  const RowMatrix f = Lobes(90, 60).cast<float>();
  EXPECT_EQ(ComputeNmf(DenseMap(f), {.terms = 3}).right,
            ComputeNmf(DenseMap(f), {.terms = 3}).right);
}

}  // namespace
}  // namespace lfm::testing
