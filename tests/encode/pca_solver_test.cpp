// SPDX-License-Identifier: BSD-3-Clause
#include "encode/pca_solver.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "tests/encode/dense_oracle.h"

namespace lfm::testing {
namespace {

constexpr PcaSolver kSolvers[] = {PcaSolver::kFactored, PcaSolver::kPaper, PcaSolver::kDense};

// Singular values 3^-i.
RowMatrix Decaying(int rows, int cols) {
  Eigen::VectorXd values(12);
  for (int i = 0; i < 12; ++i) values[i] = std::pow(3.0, -i);
  return MatrixWithSpectrum(rows, cols, values, 1).cast<float>();
}

Eigen::MatrixXd Approximation(const PcaResult& pca, int rows, int cols, int terms) {
  return Eigen::Map<const RowMatrix>(pca.left.data(), rows, pca.width)
             .leftCols(terms)
             .cast<double>() *
         Eigen::Map<const RowMatrix>(pca.right.data(), cols, pca.width)
             .leftCols(terms)
             .cast<double>()
             .transpose();
}

TEST(PcaSolver, AllFindTheSameTriplets) {
  for (const double scale : {1e-20, 1.0, 1e20}) {
    const RowMatrix f = Decaying(90, 50) * static_cast<float>(scale);
    const Eigen::MatrixXd best =
        Approximation(SolvePca(DenseMap(f), {.terms = 4}, PcaSolver::kDense), 90, 50, 4);
    EXPECT_NEAR((f.cast<double>() - best).norm() / scale, std::pow(3.0, -4) * std::sqrt(9.0 / 8),
                1e-5);
    for (const PcaSolver solver : kSolvers) {
      const PcaResult pca = SolvePca(DenseMap(f), {.terms = 4}, solver);
      ASSERT_EQ(pca.terms, 4);
      EXPECT_EQ(pca.rank, solver == PcaSolver::kPaper ? 4 : 12) << static_cast<int>(solver);
      for (int k = 0; k < 4; ++k) {
        EXPECT_NEAR(pca.singular_values[k] / scale, std::pow(3.0, -k), 1e-5) << k;
      }
      EXPECT_LE((Approximation(pca, 90, 50, 4) - best).norm() / scale, 1e-4)
          << static_cast<int>(solver);
    }
  }
}

TEST(PcaSolver, AllHoldAtTheExtremes) {
  for (const PcaSolver solver : kSolvers) {
    const RowMatrix zero = RowMatrix::Zero(30, 20), ones = RowMatrix::Ones(30, 20);
    const RowMatrix nothing(0, 20), entry = RowMatrix::Constant(1, 1, 2.F);
    EXPECT_EQ(SolvePca(DenseMap(zero), {.terms = 3}, solver).terms, 0);
    EXPECT_EQ(SolvePca(DenseMap(ones), {.terms = 0}, solver).terms, 0);
    EXPECT_EQ(SolvePca(DenseMap(ones), {.terms = 3}, solver).terms, 1);
    EXPECT_EQ(SolvePca(DenseMap(nothing), {.terms = 3}, solver).terms, 0);
    EXPECT_EQ(SolvePca(DenseMap(entry), {.terms = 3}, solver).terms, 1);
    RowMatrix bad = ones;
    bad(3, 4) = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(SolvePca(DenseMap(bad), {.terms = 3}, solver), Error);
    LinearMap hidden = DenseMap(bad);
    hidden.max_abs = 1;
    EXPECT_THROW(SolvePca(hidden, {.terms = 3}, solver), Error);
    EXPECT_THROW(SolvePca(DenseMap(ones), {.terms = 17}, solver), Error);
  }
}

}  // namespace
}  // namespace lfm::testing
