// SPDX-License-Identifier: BSD-3-Clause
#include "encode/pca.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "tests/encode/dense_oracle.h"

namespace lfm::testing {
namespace {

constexpr double kResidual_rel = 1e-6;  // excess over the optimum, of ||F||
constexpr double kOrthonormal_abs = 2e-6;
constexpr int kTerms = 4;

Eigen::MatrixXd Columns(const std::vector<float>& x, int rows, int width, int count) {
  return Eigen::Map<const RowMatrix>(x.data(), rows, width).leftCols(count).cast<double>();
}

// 300 x 120 with the given singular values.
Eigen::MatrixXd WithSpectrum(const Eigen::VectorXd& values, int seed) {
  return MatrixWithSpectrum(300, 120, values, seed);
}

struct Residuals {
  double found = 0, best = 0;  // relative to ||F||
};

Residuals Compare(const Eigen::MatrixXd& f_double, int terms, const PcaOptions& options,
                  PcaResult* out = nullptr) {
  const RowMatrix f = f_double.cast<float>();
  const Eigen::MatrixXd exact = f.cast<double>();
  const double unit = exact.cwiseAbs().maxCoeff();
  const double norm = (exact / unit).norm();
  const PcaResult pca = ComputePca(DenseMap(f), options);
  const Eigen::MatrixXd approximation =
      Columns(pca.left, f.rows(), pca.width, pca.terms) *
      (Columns(pca.right, f.cols(), pca.width, pca.terms) / unit).transpose();
  const Eigen::VectorXd values = SingularValues(exact / unit);
  const Eigen::VectorXd tail = values.tail(std::max<Eigen::Index>(0, values.size() - terms));
  if (out != nullptr) *out = pca;
  return {(exact / unit - approximation).norm() / norm, tail.norm() / norm};
}

void ExpectOptimal(const Eigen::MatrixXd& f, const char* name) {
  PcaResult pca;
  const Residuals r = Compare(f, kTerms, {.terms = kTerms}, &pca);
  EXPECT_LE(r.found, r.best + kResidual_rel) << name << " after " << pca.passes << " passes";
  const Eigen::MatrixXd u = Columns(pca.left, static_cast<int>(f.rows()), pca.width, pca.rank);
  const Eigen::MatrixXd gram = u.transpose() * u;
  EXPECT_LE((gram - Eigen::MatrixXd::Identity(pca.rank, pca.rank)).cwiseAbs().maxCoeff(),
            kOrthonormal_abs)
      << name;
  for (const float value : pca.left) ASSERT_TRUE(std::isfinite(value)) << name;
  for (const float value : pca.right) ASSERT_TRUE(std::isfinite(value)) << name;
}

TEST(Pca, IsOptimalWhereTheSpectrumFallsOff) {
  Eigen::VectorXd decay(120);
  for (int i = 0; i < 120; ++i) decay[i] = std::pow(10.0, -12.0 * i / 119);
  ExpectOptimal(WithSpectrum(decay, 1), "decay to 1e-12");
  Eigen::VectorXd gap = Eigen::VectorXd::Constant(120, 1e-3);
  gap.head(4) << 5, 3, 2, 1;
  ExpectOptimal(WithSpectrum(gap, 2), "gap over a flat tail");
}

TEST(Pca, IsOptimalForTheMostTerms) {
  Eigen::VectorXd values(120);
  for (int i = 0; i < 120; ++i) values[i] = std::pow(0.7, i);
  PcaResult pca;
  const Residuals r = Compare(WithSpectrum(values, 18), 16, {.terms = 16}, &pca);
  EXPECT_EQ(pca.terms, 16);
  EXPECT_EQ(pca.width, 24);
  EXPECT_LE(r.found, r.best + kResidual_rel);
}

TEST(Pca, IsOptimalForLowAndRepeatedRank) {
  ExpectOptimal(WithSpectrum(Eigen::VectorXd::Constant(1, 3.0), 3), "rank 1");
  ExpectOptimal(WithSpectrum(Eigen::Vector3d(3, 2, 0.001), 4), "rank 3, below K");
  Eigen::VectorXd repeated = Eigen::VectorXd::Constant(20, 0.01);
  repeated.head(4).setConstant(1);
  ExpectOptimal(WithSpectrum(repeated, 5), "first four repeated");
  ExpectOptimal(WithSpectrum(Eigen::VectorXd::Constant(12, 1.0), 6), "all equal, rank 12");
  ExpectOptimal(Eigen::MatrixXd::Constant(300, 120, 0.7), "constant");
  ExpectOptimal(RandomNormal(300, 1, 7) * Eigen::RowVectorXd::Ones(120), "equal columns");
}

TEST(Pca, IsOptimalForThinMatrices) {
  ExpectOptimal(RandomNormal(300, 1, 8), "one column");
  ExpectOptimal(RandomNormal(1, 120, 9), "one row");
  ExpectOptimal(RandomNormal(3, 120, 10), "three rows");
  ExpectOptimal(RandomNormal(1, 1, 11), "one entry");
}

TEST(Pca, IsOptimalAtExtremeScales) {
  Eigen::VectorXd values(30);
  for (int i = 0; i < 30; ++i) values[i] = std::pow(2.0, -i);
  const Eigen::MatrixXd f = WithSpectrum(values, 12);
  for (const double scale : {1e-25, 1e-10, 1.0, 1e10, 1e25}) {
    ExpectOptimal(scale * f, ("scale " + std::to_string(std::log10(scale))).c_str());
  }
}

TEST(Pca, ComesCloseForWhiteNoise) {
  const Residuals r = Compare(RandomNormal(300, 120, 13), kTerms, {.terms = kTerms});
  EXPECT_LE(r.found, r.best + 2e-3);
}

TEST(Pca, SingularValuesAgreeWithTheOracle) {
  Eigen::VectorXd values(20);
  for (int i = 0; i < 20; ++i) values[i] = std::pow(3.0, -i);
  const RowMatrix f = WithSpectrum(values, 14).cast<float>();
  const PcaResult pca = ComputePca(DenseMap(f), {.terms = 6});
  ASSERT_EQ(pca.terms, 6);
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(pca.singular_values[k], values[k], 1e-6) << k;
}

TEST(Pca, IsProgressive) {
  Eigen::VectorXd values(40);
  for (int i = 0; i < 40; ++i) values[i] = 1.0 / (1 + i * i);
  const Eigen::MatrixXd f = WithSpectrum(values, 15);
  const RowMatrix f_float = f.cast<float>();
  const PcaResult pca = ComputePca(DenseMap(f_float), {.terms = 8});
  for (int k = 1; k <= 8; ++k) {
    const Eigen::MatrixXd first =
        Columns(pca.left, 300, pca.width, k) * Columns(pca.right, 120, pca.width, k).transpose();
    const double best = values.tail(40 - k).norm();
    EXPECT_LE((f - first).norm(), best + 1e-5 * values.norm()) << k << " of 8 terms";
  }
}

TEST(Pca, GivesNoTermsWithoutEnergy) {
  const RowMatrix zero = RowMatrix::Zero(30, 20);
  EXPECT_EQ(ComputePca(DenseMap(zero), {.terms = 3}).terms, 0);
  const RowMatrix some = RowMatrix::Ones(30, 20);
  EXPECT_EQ(ComputePca(DenseMap(some), {.terms = 0}).terms, 0);
  EXPECT_EQ(ComputePca(DenseMap(some), {.terms = 3}).terms, 1);
  const RowMatrix nothing(0, 20);
  EXPECT_EQ(ComputePca(DenseMap(nothing), {.terms = 3}).terms, 0);
}

TEST(Pca, RejectsWhatIsNotFinite) {
  RowMatrix f = RowMatrix::Ones(30, 20);
  f(3, 4) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(ComputePca(DenseMap(f), {.terms = 3}), Error);
  LinearMap hidden = DenseMap(f);
  hidden.max_abs = 1;
  EXPECT_THROW(ComputePca(hidden, {.terms = 3}), Error);
  f(3, 4) = std::numeric_limits<float>::infinity();
  EXPECT_THROW(ComputePca(DenseMap(f), {.terms = 3}), Error);
  f(3, 4) = 1;
  EXPECT_THROW(ComputePca(DenseMap(f), {.terms = 17}), Error);
}

TEST(Pca, RepeatsItself) {
  const RowMatrix f = RandomNormal(90, 60, 16).cast<float>();
  EXPECT_EQ(ComputePca(DenseMap(f), {.terms = 3}).right,
            ComputePca(DenseMap(f), {.terms = 3}).right);
}

TEST(Orthonormalize, DropsDependentColumns) {
  RowMatrix x = RowMatrix::Zero(50, 8);
  const Eigen::MatrixXd basis = RandomNormal(50, 2, 17);
  for (int c = 0; c < 6; ++c) x.col(c) = (basis.col(c % 2) * std::pow(10.0, c)).cast<float>();
  std::vector<float> values(x.data(), x.data() + x.size());
  ASSERT_EQ(Orthonormalize(values, 50, 8), 2);
  const Eigen::MatrixXd q = Columns(values, 50, 8, 8);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(8, 8);
  expected.topLeftCorner(2, 2).setIdentity();
  EXPECT_LE((q.transpose() * q - expected).cwiseAbs().maxCoeff(), kOrthonormal_abs);
}

}  // namespace
}  // namespace lfm::testing
