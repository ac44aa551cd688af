// SPDX-License-Identifier: BSD-3-Clause
#include "encode/precise_pca.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "encode/pca_solver.h"
#include "encode/pseudo_random.h"
#include "encode/vertex_factorization.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

constexpr double kOptimum_rel = 1e-10;

PreciseMap MapOf(const Eigen::MatrixXd& f) {
  return {static_cast<int>(f.rows()), static_cast<int>(f.cols()),
          [f](const Eigen::MatrixXd& x) -> Eigen::MatrixXd { return f * x; },
          [f](const Eigen::MatrixXd& y) -> Eigen::MatrixXd { return f.transpose() * y; }};
}

Eigen::MatrixXd Random(int rows, int cols, int seed) {
  PseudoRandom random;
  for (int skip = 0; skip < 1000 * seed; ++skip) random.Next();
  Eigen::MatrixXd x(rows, cols);
  for (double& value : x.reshaped()) value = random.Next();
  return x;
}

// A matrix with these singular values.
Eigen::MatrixXd WithSpectrum(int rows, int cols, const Eigen::VectorXd& values) {
  const auto orthonormal = [&](int n, int seed) -> Eigen::MatrixXd {
    const Eigen::MatrixXd x = Random(n, static_cast<int>(values.size()), seed);
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(x);
    return qr.householderQ() * Eigen::MatrixXd::Identity(n, values.size());
  };
  return orthonormal(rows, 1) * values.asDiagonal() * orthonormal(cols, 2).transpose();
}

// (||F - F_K|| - optimum) / ||F||
double AboveOptimum(const Eigen::MatrixXd& f, const PrecisePca& pca, int terms) {
  const int k = std::min(terms, pca.terms);
  const double error = (f - pca.left.leftCols(k) * pca.right.leftCols(k).transpose()).norm();
  const Eigen::VectorXd values = Eigen::BDCSVD<Eigen::MatrixXd>(f).singularValues();
  return (error -
          values.tail(values.size() - std::min<Eigen::Index>(terms, values.size())).norm()) /
         f.norm();
}

TEST(PrecisePca, IsOptimalToTenDigits) {
  Eigen::VectorXd values(60);
  for (int i = 0; i < values.size(); ++i) values[i] = std::pow(0.8, i);
  const Eigen::MatrixXd f = WithSpectrum(200, 90, values);
  for (const int terms : {1, 3, 8, 16}) {
    const PrecisePca pca = ComputePrecisePca(MapOf(f), terms);
    EXPECT_EQ(pca.terms, terms);
    EXPECT_LT(std::abs(AboveOptimum(f, pca, terms)), kOptimum_rel) << terms;
    EXPECT_LT((pca.singular_values.head(terms) - values.head(terms)).norm(), 1e-10);
  }
}

TEST(PrecisePca, HoldsAtTheExtremes) {
  const Eigen::MatrixXd rank_two = WithSpectrum(50, 40, Eigen::Vector2d(3, 3));
  const PrecisePca two = ComputePrecisePca(MapOf(rank_two), 4);
  EXPECT_EQ(two.terms, 2);
  EXPECT_LT(AboveOptimum(rank_two, two, 4), kOptimum_rel);
  for (const double scale : {1e-100, 1e100}) {
    const Eigen::MatrixXd f = scale * Random(30, 20, 3);
    EXPECT_LT(std::abs(AboveOptimum(f, ComputePrecisePca(MapOf(f), 5), 5)), kOptimum_rel);
  }
  EXPECT_EQ(ComputePrecisePca(MapOf(Eigen::MatrixXd::Zero(9, 7)), 3).terms, 0);
  EXPECT_EQ(ComputePrecisePca(MapOf(Random(9, 7, 1)), 0).terms, 0);
  const Eigen::MatrixXd column = Random(9, 1, 1);
  EXPECT_LT(AboveOptimum(column, ComputePrecisePca(MapOf(column), 3), 3), kOptimum_rel);
}

TEST(PrecisePca, RejectsWhatIsNotFinite) {
  Eigen::MatrixXd f = Random(9, 7, 1);
  f(3, 4) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(ComputePrecisePca(MapOf(f), 3), Error);
  EXPECT_THROW(ComputePrecisePca(MapOf(Random(9, 7, 1)), 17), Error);
}

TEST(PrecisePca, AVertexHasTheSameTripletsAsInSinglePrecision) {
  const SyntheticLightField field = MakeLightField(
      MakeSphere(1), 8, 40, [](int) { return 7; }, GlossyAppearance);
  const VertexRings rings = ComputeVertexRings(field.mesh);
  const std::span<const int> ring(rings.triangles.data() + rings.offsets[5],
                                  rings.triangles.data() + rings.offsets[6]);
  LightFieldSource source = field.Source();
  source.change = [&](int triangle, int, const ViewWeights&) {
    std::vector<float> change(9 * field.grid * field.grid);
    for (size_t i = 0; i < change.size(); ++i) {
      change[i] = 0.1F * std::sin(0.3F * static_cast<float>(i) + static_cast<float>(triangle));
    }
    return change;
  };
  const VertexOperator f = BuildVertexOperator(source, 5, ring, [&](int t) {
    return PatchMean(3 * PatchSampleCount(field.triangles[t].edge_samples), 0.4F);
  });
  const std::vector<float> scale = ColumnScale(f, 0.2);
  const PreciseMap precise = PreciseScaledMap(f, scale);
  const LinearMap single = ScaledMap(f, scale);
  const Eigen::MatrixXd dense = precise.multiply(Eigen::MatrixXd::Identity(f.cols(), f.cols()));
  const Eigen::MatrixXd formed = FormMatrix(single).cast<double>() * single.max_abs;
  EXPECT_LT((dense - formed).norm(), 1e-6 * dense.norm());
  const Eigen::MatrixXd transposed =
      precise.multiply_transposed(Eigen::MatrixXd::Identity(f.rows, f.rows));
  EXPECT_LT((dense - transposed.transpose()).norm(), 1e-13 * dense.norm());
  const PrecisePca pca = ComputePrecisePca(precise, 3);
  EXPECT_LT(std::abs(AboveOptimum(dense, pca, 3)), kOptimum_rel);
  const PcaResult rounded = RoundedToFloat(pca, f.rows, f.cols());
  const PcaResult by_float = ComputePca(single, {.terms = 3});
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(rounded.singular_values[k], by_float.singular_values[k],
                1e-5 * by_float.singular_values[0]);
  }
}

}  // namespace
}  // namespace lfm::testing
