// SPDX-License-Identifier: BSD-3-Clause
#include "fields/zonal_harmonics.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "fields/dimension.h"
#include "fields/gauss_legendre.h"
#include "fields/slope_fit.h"

namespace lfm {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(GaussLegendre, IntegratesPolynomials) {
  for (const int count : {1, 2, 5, 40}) {
    const Quadrature rule = GaussLegendre(count, -1, 3);
    const int degree = 2 * count - 1;
    double sum = 0;
    for (int i = 0; i < count; ++i) sum += rule.weights[i] * std::pow(rule.nodes[i] / 3, degree);
    const double exact = (3 - std::pow(-1.0 / 3, degree + 1) * 3) / (degree + 1);
    EXPECT_NEAR(sum, exact, 1e-12);
  }
  EXPECT_THROW(GaussLegendre(0, 0, 1), Error);
  EXPECT_THROW(GaussLegendre(3, 1, 1), Error);
}

TEST(ZonalHarmonics, KnownKernels) {
  const auto constant = ZonalCoefficients([](double) { return 1.0; }, 3, 16);
  EXPECT_NEAR(constant[0], 4 * kPi, 1e-12);
  for (int l = 1; l <= 3; ++l) EXPECT_NEAR(constant[l], 0, 1e-12);
  // P_2: 4 pi / 5 at degree 2, nothing elsewhere.
  const auto second = ZonalCoefficients([](double t) { return 1.5 * t * t - 0.5; }, 4, 16);
  for (int l = 0; l <= 4; ++l) EXPECT_NEAR(second[l], l == 2 ? 4 * kPi / 5 : 0, 1e-12);
}

TEST(ZonalHarmonics, LambertsCosine) {
  const double expected[] = {kPi, 2 * kPi / 3, kPi / 4, 0, -kPi / 24, 0, kPi / 64};
  const auto closed = PhongZonalCoefficients(1, 6);
  const auto integrated = ZonalCoefficients([](double t) { return std::max(t, 0.0); }, 6, 32);
  for (int l = 0; l <= 6; ++l) {
    EXPECT_NEAR(closed[l], expected[l], 1e-14);
    EXPECT_NEAR(integrated[l], expected[l], 1e-12);
  }
}

TEST(ZonalHarmonics, PhongInClosedFormIsItsIntegral) {
  const auto closed = PhongZonalCoefficients(50.5, 40);
  const auto integrated =
      ZonalCoefficients([](double t) { return t > 0 ? std::pow(t, 50.5) : 0; }, 40, 200);
  for (int l = 0; l <= 40; ++l) EXPECT_NEAR(closed[l], integrated[l], 1e-12);
  // As a sum of harmonics it is the lobe again.
  const auto many = PhongZonalCoefficients(20, 60);
  EXPECT_NEAR(EvaluateZonal(many, 0.9), std::pow(0.9, 20), 1e-7);
  EXPECT_EQ(EvaluateZonal({}, 0.9), 0);
}

TEST(ZonalHarmonics, WholeSphereHasTheFunksHeckeEigenvalues) {
  const auto f = PhongZonalCoefficients(12, 40);
  const auto values = CapEigenvalues(f, kPi);
  std::vector<double> expected = WithMultiplicity(SquaredCoefficients(f));
  ASSERT_GE(values.size(), 50u);
  for (int i = 0; i < 50; ++i) EXPECT_NEAR(values[i], expected[i], 1e-12 * expected[0]);
}

// A constant f sees the cap's area alone: one eigenvalue, (4 pi)^2 / (4 pi) times the area's share.
TEST(ZonalHarmonics, ConstantKernelOnACap) {
  const double beta = 0.7, area = 2 * kPi * (1 - std::cos(beta));
  const auto values = CapEigenvalues(ZonalCoefficients([](double) { return 1.0; }, 8, 16), beta);
  ASSERT_FALSE(values.empty());
  EXPECT_NEAR(values[0], 4 * kPi * area, 1e-10);
  for (size_t i = 1; i < values.size(); ++i) EXPECT_NEAR(values[i], 0, 1e-10);
}

// f = cos: M(a, b) = 4 pi / 3 a . b, so the eigenvalues are 4 pi / 3 times the cap's moments of
// inertia: along the axis, and twice across.
TEST(ZonalHarmonics, CosineKernelOnACap) {
  const double beta = 1.1, c = std::cos(beta);
  const double along = 2 * kPi * (1 - c * c * c) / 3;
  const double across = 0.5 * (2 * kPi * (1 - c) - along);
  const auto values = CapEigenvalues(ZonalCoefficients([](double t) { return t; }, 4, 16), beta);
  std::vector<double> expected = {along, across, across};
  std::sort(expected.rbegin(), expected.rend());
  ASSERT_GE(values.size(), 3u);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(values[i], 4 * kPi / 3 * expected[i], 1e-10);
  EXPECT_EQ(
      CapEigenvaluesOfOrder(ZonalCoefficients([](double t) { return t; }, 1, 16), beta, 2).size(),
      0u);
}

// Against brute force: M = g(a . b) at points spread evenly over the cap, by the midpoint rule.
TEST(ZonalHarmonics, CapAgreesWithADiscretisedOne) {
  const double beta = 0.9;
  const auto f = PhongZonalCoefficients(15, 40);
  const auto g = SquaredCoefficients(f);
  const int count = 900;
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (1 - std::cos(beta)) * (i + 0.5) / count, r = std::sqrt(1 - z * z);
    const double turn = kPi * (3 - std::sqrt(5.0)) * i;
    points.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
  }
  Eigen::MatrixXd matrix(count, count);
  const double weight = 2 * kPi * (1 - std::cos(beta)) / count;
  std::vector<double> table;
  for (int i = 0; i <= 4000; ++i) table.push_back(EvaluateZonal(g, std::cos(i * kPi / 4000)));
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      const double at = std::acos(std::min(1.0, points[i].dot(points[j]))) / kPi * 4000;
      const auto k = std::min(3999, static_cast<int>(at));
      matrix(i, j) = weight * (table[k] + (at - k) * (table[k + 1] - table[k]));
    }
  }
  const Eigen::VectorXd brute =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
  const auto values = CapEigenvalues(f, beta);
  for (int i = 0; i < 12; ++i) {
    EXPECT_NEAR(values[i], brute[count - 1 - i], 0.01 * values[0]) << i;
  }
}

TEST(ZonalHarmonics, TraceIsTheCapsArea) {
  const auto f = PhongZonalCoefficients(30, 80);
  const auto g = SquaredCoefficients(f);
  double sum = 0;
  for (const double value : CapEigenvalues(f, 0.6)) sum += value;
  EXPECT_NEAR(sum, EvaluateZonal(g, 1) * 2 * kPi * (1 - std::cos(0.6)), 1e-9);
}

// Narrow lobes see a plane: H_(2 l) = G_l / 4 for h(theta) = g(2 theta).
TEST(ZonalHarmonics, ScaleTheoremHoldsForNarrowLobes) {
  const auto g = SquaredCoefficients(PhongZonalCoefficients(800, 300));
  const auto h = ScaledCoefficients(g, 2, 200);
  for (const int l : {10, 20, 40}) EXPECT_NEAR(4 * h[2 * l], g[l], 0.02 * g[0]) << l;
  const auto same = ScaledCoefficients(g, 1, 40);
  for (const int l : {0, 7, 40}) EXPECT_NEAR(same[l], g[l], 1e-10 * g[0]);
  EXPECT_THROW(ScaledCoefficients(g, 0, 4), Error);
}

// Mahajan 2007, Figure 7a: the mirrored direction of a sphere covers a cap.
TEST(ZonalHarmonics, DimensionOfASharpLobeGrowsWithTheCap) {
  const auto f = PhongZonalCoefficients(500, 200);
  std::vector<double> areas, dimensions;
  for (int octave = 0; octave <= 3; ++octave) {
    areas.push_back(std::exp2(octave - 4));  // of the sphere
    dimensions.push_back(DimensionOf(CapEigenvalues(f, std::acos(1 - 2 * areas.back())), 0.9995));
  }
  EXPECT_GE(FitSlope(areas, dimensions)->slope, 0.9);
}

TEST(ZonalHarmonics, Extremes) {
  EXPECT_THROW(CapEigenvalues({1}, 0), Error);
  EXPECT_THROW(CapEigenvalues({1}, 3.2), Error);
  EXPECT_TRUE(CapEigenvalues({0, 0}, 1).empty());
  EXPECT_TRUE(CapEigenvalues({}, 1).empty());
  EXPECT_EQ(SignificantDegrees({1, 0, 0}), 1);
  EXPECT_THROW(PhongZonalCoefficients(-1, 3), Error);
  EXPECT_THROW(ZonalCoefficients([](double) { return 1.0; }, -1, 3), Error);
}

}  // namespace
}  // namespace lfm
