// SPDX-License-Identifier: BSD-3-Clause
#include "fields/toeplitz_spectrum.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "core/error.h"

namespace lfm {
namespace {

constexpr double kPi = std::numbers::pi;

void AddEigenvalues(const Eigen::MatrixXd& matrix, std::vector<double>& all) {
  if (matrix.rows() == 0) return;
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
  all.insert(all.end(), values.data(), values.data() + values.size());
}

}  // namespace

FlatCovariance CovarianceOf(std::function<double(double angle)> f, int samples) {
  if (samples < 1) throw Error("a covariance needs a sample at least");
  // Only the second factor moves with d: the first is tabulated, and what is zero in it left out.
  std::vector<std::pair<double, double>> first;
  const double step = 2 * kPi / samples;
  for (int i = 0; i < samples; ++i) {
    const double u = -kPi + i * step, value = f(u);
    if (value != 0) first.emplace_back(u, value * step);
  }
  return [first = std::move(first), f = std::move(f)](double d) {
    double sum = 0;
    for (const auto& [u, value] : first) sum += value * f(d - u);
    return sum;
  };
}

FlatCovariance PhongCovariance(double exponent) {
  if (!(exponent >= 1 && exponent <= 1e6)) {
    throw Error("Phong exponent " + std::to_string(exponent) + " is not between 1 and 1e6");
  }
  // Lobes are about 1 / sqrt(exponent) wide.
  const int samples = 64 * static_cast<int>(std::ceil(16 + 2 * std::sqrt(exponent)));
  return CovarianceOf(
      [exponent](double x) { return std::pow(std::max(std::cos(x), 0.0), exponent); }, samples);
}

FlatCovariance StepCovariance() {
  return [](double d) { return kPi - std::abs(std::remainder(d, 2 * kPi)); };
}

std::vector<double> SampleCovariance(const FlatCovariance& g, double beta, int p) {
  if (p < 1 || p > 20000) {
    throw Error("a covariance matrix of " + std::to_string(p) + " pixels is out of range");
  }
  if (!(beta > 0 && beta <= kPi)) {
    throw Error("beta must lie above 0 and up to pi, not at " + std::to_string(beta));
  }
  std::vector<double> samples(p);
  for (int k = 0; k < p; ++k) samples[k] = g(2 * beta * k / p);
  return samples;
}

std::vector<double> ToeplitzEigenvalues(const std::vector<double>& g) {
  for (const double value : g) {
    if (!std::isfinite(value)) throw Error("a Toeplitz matrix holds a number that is not finite");
  }
  const auto p = static_cast<Eigen::Index>(g.size());
  const Eigen::Index half = p / 2, even = p - half;
  Eigen::MatrixXd symmetric(even, even), antisymmetric(half, half);
  for (Eigen::Index i = 0; i < half; ++i) {
    for (Eigen::Index j = 0; j < half; ++j) {
      const double direct = g[std::abs(i - j)], mirrored = g[p - 1 - i - j];
      symmetric(i, j) = direct + mirrored;
      antisymmetric(i, j) = direct - mirrored;
    }
  }
  if (even > half) {  // the middle stands for itself
    for (Eigen::Index i = 0; i < half; ++i) {
      symmetric(i, half) = symmetric(half, i) = std::numbers::sqrt2 * g[half - i];
    }
    symmetric(half, half) = g[0];
  }
  std::vector<double> values;
  AddEigenvalues(symmetric, values);
  AddEigenvalues(antisymmetric, values);
  std::sort(values.rbegin(), values.rend());
  return values;
}

std::vector<double> TruncatedFourier(const std::vector<double>& g) {
  const size_t p = g.size();
  std::vector<double> cosine(p), values(p);
  for (size_t i = 0; i < p; ++i) {
    cosine[i] = std::cos(2 * kPi * static_cast<double>(i) / static_cast<double>(p));
  }
  for (size_t r = 0; r < p; ++r) {
    double sum = 0;
    size_t angle = 0;
    for (size_t k = 1; k < p; ++k) {
      angle += r;
      if (angle >= p) angle -= p;
      sum += g[k] * cosine[angle];
    }
    values[r] = g[0] + 2 * sum;
  }
  std::sort(values.rbegin(), values.rend());
  return values;
}

double SummedDifference(const std::vector<double>& a, const std::vector<double>& b) {
  double difference = 0, sum = 0;
  for (size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
    const double x = i < a.size() ? a[i] : 0, y = i < b.size() ? b[i] : 0;
    difference += std::abs(x - y);
    sum += std::abs(x);
  }
  if (sum > 0) return difference / sum;
  return difference > 0 ? std::numeric_limits<double>::infinity() : 0;
}

}  // namespace lfm
