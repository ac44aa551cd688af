// SPDX-License-Identifier: BSD-3-Clause
#include "fields/toeplitz_spectrum.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "core/error.h"
#include "fields/dimension.h"
#include "fields/slope_fit.h"

namespace lfm {
namespace {

constexpr double kPi = std::numbers::pi;

double Sum(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum;
}

TEST(ToeplitzSpectrum, AgreesWithTheWholeMatrix) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (const int p : {1, 2, 3, 8, 31}) {
    std::vector<double> g(p);
    for (double& value : g) value = normal(random);
    Eigen::MatrixXd matrix(p, p);
    for (int i = 0; i < p; ++i) {
      for (int j = 0; j < p; ++j) matrix(i, j) = g[std::abs(i - j)];
    }
    const Eigen::VectorXd expected =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix).eigenvalues();
    const std::vector<double> values = ToeplitzEigenvalues(g);
    ASSERT_EQ(values.size(), static_cast<size_t>(p));
    for (int i = 0; i < p; ++i) EXPECT_NEAR(values[i], expected[p - 1 - i], 1e-12 * p);
  }
}

// The second difference: 2 - 2 cos(k pi / (p + 1)).
TEST(ToeplitzSpectrum, SecondDifferenceIsKnown) {
  const int p = 40;
  std::vector<double> g(p);
  g[0] = 2, g[1] = -1;
  const std::vector<double> values = ToeplitzEigenvalues(g);
  for (int k = 1; k <= p; ++k) {
    EXPECT_NEAR(values[p - k], 2 - 2 * std::cos(k * kPi / (p + 1)), 1e-12);
  }
}

// With g_k = g_(p - k) the matrix is circulant: its eigenvalues are the Fourier transform of its
// first row. Equation 8 counts every k != 0 twice, so with c_k for the row, g_k = c_k / 2 + c_0 ...
// it is 2 DFT(g)_r - g_0.
TEST(ToeplitzSpectrum, CirculantEigenvaluesAreTheFourierTransform) {
  const int p = 24;
  std::vector<double> g(p), transform(p);
  for (int k = 0; k < p; ++k) g[k] = std::exp(2 * std::cos(2 * kPi * k / p));
  for (int r = 0; r < p; ++r) {
    for (int k = 0; k < p; ++k) transform[r] += g[k] * std::cos(2 * kPi * k * r / p);
  }
  std::sort(transform.rbegin(), transform.rend());
  const std::vector<double> eigenvalues = ToeplitzEigenvalues(g), doubled = TruncatedFourier(g);
  for (int r = 0; r < p; ++r) {
    EXPECT_NEAR(eigenvalues[r], transform[r], 1e-12 * transform[0]);
    EXPECT_NEAR(doubled[r], 2 * transform[r] - g[0], 1e-12 * transform[0]);
  }
}

// Where g falls to zero well inside the patch, both sides of Equation 8 agree.
TEST(ToeplitzSpectrum, NarrowCovarianceIsItsFourierTransform) {
  std::vector<double> g(400);
  for (int k = 0; k < 400; ++k) g[k] = std::exp(-0.5 * k * k / 4.0);
  const std::vector<double> eigenvalues = ToeplitzEigenvalues(g), fourier = TruncatedFourier(g);
  EXPECT_LT(SummedDifference(eigenvalues, fourier), 0.02);
  EXPECT_NEAR(Sum(eigenvalues), 400 * g[0], 1e-9);
  EXPECT_NEAR(Sum(fourier), 400 * g[0], 1e-9);
}

TEST(ToeplitzSpectrum, CovariancesAreKnown) {
  // Lambert's clamped cosine: g(0) = integral of cos^2 over a half circle.
  EXPECT_NEAR(PhongCovariance(1)(0), kPi / 2, 1e-3);
  // g(d) = ((pi - d) cos d + sin d) / 2 for d in [0, pi].
  EXPECT_NEAR(PhongCovariance(1)(1.0), ((kPi - 1) * std::cos(1.0) + std::sin(1.0)) / 2, 1e-3);
  // cos^2 clamped: 3 pi / 8.
  EXPECT_NEAR(PhongCovariance(2)(0), 3 * kPi / 8, 1e-5);
  EXPECT_NEAR(StepCovariance()(0.5), kPi - 0.5, 1e-15);
  EXPECT_NEAR(StepCovariance()(-0.5), kPi - 0.5, 1e-15);
  EXPECT_NEAR(CovarianceOf([](double x) { return std::cos(x); }, 64)(0.3), kPi * std::cos(0.3),
              1e-12);
  EXPECT_THROW(PhongCovariance(0.5), Error);
  EXPECT_THROW(CovarianceOf([](double) { return 1.0; }, 0), Error);
}

// The step's covariance pi - |d|, like that of Brownian motion, has eigenvalues that fall as 1 /
// k^2: dimension and patch grow alike.
TEST(ToeplitzSpectrum, DimensionOfAStepGrowsWithThePatch) {
  std::vector<double> widths, steps, lobes;
  for (int octave = 0; octave <= 3; ++octave) {
    widths.push_back(kPi / 2 * std::exp2(octave - 3));
    const auto dimension = [&](const FlatCovariance& g) {
      return DimensionOf(ToeplitzEigenvalues(SampleCovariance(g, widths.back(), 700)), 0.999);
    };
    steps.push_back(dimension(StepCovariance()));
    lobes.push_back(dimension(PhongCovariance(500)));
  }
  EXPECT_NEAR(FitSlope(widths, steps)->slope, 1, 0.1);
  EXPECT_GE(FitSlope(widths, lobes)->slope, 0.9);
}

// The FINDINGS of the paper's Figure 4: good for half a circle, worse for less.
TEST(ToeplitzSpectrum, FourierFitsLargePatchesOnly) {
  std::vector<double> differences;
  for (const double beta : {kPi / 2, kPi / 4, kPi / 8}) {
    const std::vector<double> g = SampleCovariance(PhongCovariance(50), beta, 300);
    differences.push_back(SummedDifference(ToeplitzEigenvalues(g), TruncatedFourier(g)));
  }
  EXPECT_LT(differences[0], 0.10);
  EXPECT_NEAR(differences[1], 0.16, 0.02);
  EXPECT_NEAR(differences[2], 0.33, 0.03);
}

TEST(ToeplitzSpectrum, Extremes) {
  EXPECT_TRUE(ToeplitzEigenvalues({}).empty());
  EXPECT_TRUE(TruncatedFourier({}).empty());
  EXPECT_EQ(TruncatedFourier({3.0})[0], 3);
  EXPECT_EQ(SummedDifference({}, {}), 0);
  EXPECT_EQ(SummedDifference({2, 2}, {3}), 0.75);
  EXPECT_TRUE(std::isinf(SummedDifference({0}, {1})));
  EXPECT_THROW(ToeplitzEigenvalues({1, std::numeric_limits<double>::infinity()}), Error);
  EXPECT_THROW(SampleCovariance(StepCovariance(), 0, 10), Error);
  EXPECT_THROW(SampleCovariance(StepCovariance(), 4, 10), Error);
  EXPECT_THROW(SampleCovariance(StepCovariance(), 1, 0), Error);
}

}  // namespace
}  // namespace lfm
