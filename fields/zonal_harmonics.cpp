// SPDX-License-Identifier: BSD-3-Clause
#include "fields/zonal_harmonics.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/gauss_legendre.h"

namespace lfm {
namespace {

constexpr double kPi = std::numbers::pi;

void RequireDegree(int max_degree) {
  if (max_degree < 0 || max_degree > 20000) {
    throw Error("spherical harmonics up to degree " + std::to_string(max_degree) +
                " are out of range");
  }
}

void RequireCap(double beta) {
  if (!(beta > 0 && beta <= kPi)) {
    throw Error("a cap's angle must lie above 0 and up to pi, not at " + std::to_string(beta));
  }
}

// P_0 to P_max at t.
std::vector<double> Legendre(int max_degree, double t) {
  std::vector<double> p(max_degree + 1, 1.0);
  if (max_degree >= 1) p[1] = t;
  for (int l = 2; l <= max_degree; ++l) {
    p[l] = ((2 * l - 1) * t * p[l - 1] - (l - 1) * p[l - 2]) / l;
  }
  return p;
}

// Associated Legendre functions of order m and degrees m to max at t, scaled so that their squares
// integrate to 1 over [-1, 1].
std::vector<double> NormalizedLegendre(int max_degree, int m, double t) {
  std::vector<double> p(max_degree - m + 1);
  const double sine2 = std::max(0.0, (1 - t) * (1 + t));
  double log_first = 0.5 * std::log(0.5);
  for (int k = 1; k <= m; ++k) log_first += 0.5 * std::log((2.0 * k + 1) / (2.0 * k));
  p[0] =
      m == 0 ? std::sqrt(0.5) : std::exp(log_first + 0.5 * m * std::log(std::max(sine2, 1e-300)));
  if (max_degree > m) p[1] = std::sqrt(2.0 * m + 3) * t * p[0];
  for (int l = m + 2; l <= max_degree; ++l) {
    const double l2 = double(l) * l, m2 = double(m) * m;
    const double a = std::sqrt((4 * l2 - 1) / (l2 - m2));
    const double b = std::sqrt(((l - 1.0) * (l - 1.0) - m2) / (4 * (l - 1.0) * (l - 1.0) - 1));
    p[l - m] = a * (t * p[l - m - 1] - b * p[l - m - 2]);
  }
  return p;
}

}  // namespace

std::vector<double> ZonalCoefficients(const ZonalFunction& f, int max_degree, int nodes) {
  RequireDegree(max_degree);
  std::vector<double> coefficients(max_degree + 1);
  for (const auto& [low, high] : {std::pair{-1.0, 0.0}, std::pair{0.0, 1.0}}) {
    const Quadrature rule = GaussLegendre(nodes, low, high);
    for (int i = 0; i < nodes; ++i) {
      const double value = 2 * kPi * rule.weights[i] * f(rule.nodes[i]);
      if (value == 0) continue;
      const std::vector<double> p = Legendre(max_degree, rule.nodes[i]);
      for (int l = 0; l <= max_degree; ++l) coefficients[l] += value * p[l];
    }
  }
  return coefficients;
}

std::vector<double> PhongZonalCoefficients(double exponent, int max_degree) {
  RequireDegree(max_degree);
  if (!(exponent >= 0 && exponent <= 1e6)) {
    throw Error("Phong exponent " + std::to_string(exponent) + " is not between 0 and 1e6");
  }
  std::vector<double> coefficients(max_degree + 1);
  for (int l = 0; l <= max_degree; ++l) {
    coefficients[l] = l == 0   ? 2 * kPi / (exponent + 1)
                      : l == 1 ? 2 * kPi / (exponent + 2)
                               : coefficients[l - 2] * (exponent - l + 2) / (exponent + l + 1);
  }
  return coefficients;
}

double EvaluateZonal(const std::vector<double>& coefficients, double cosine) {
  if (coefficients.empty()) return 0;
  const std::vector<double> p = Legendre(static_cast<int>(coefficients.size()) - 1, cosine);
  double sum = 0;
  for (size_t l = 0; l < p.size(); ++l) {
    sum += (2 * static_cast<double>(l) + 1) / (4 * kPi) * coefficients[l] * p[l];
  }
  return sum;
}

int SignificantDegrees(const std::vector<double>& coefficients) {
  const auto energy = [&](size_t l) {
    return (2 * static_cast<double>(l) + 1) * coefficients[l] * coefficients[l];
  };
  double sum = 0, tail = 0;
  for (size_t l = 0; l < coefficients.size(); ++l) sum += energy(l);
  size_t count = coefficients.size();
  while (count > 0 && (tail += energy(count - 1)) <= 1e-12 * sum) --count;
  return static_cast<int>(count);
}

std::vector<double> CapEigenvaluesOfOrder(const std::vector<double>& coefficients, double beta,
                                          int order) {
  RequireCap(beta);
  const int degrees = static_cast<int>(coefficients.size());
  if (order < 0 || order >= degrees) return {};
  // Products of two functions are polynomials in the cosine, of degree 2 (degrees - 1) at most.
  const Quadrature rule = GaussLegendre(degrees, std::cos(beta), 1.0);
  Eigen::MatrixXd root(degrees - order, degrees);  // M = root^T root at the nodes
  for (int i = 0; i < degrees; ++i) {
    const std::vector<double> p = NormalizedLegendre(degrees - 1, order, rule.nodes[i]);
    const double weight = std::sqrt(rule.weights[i]);
    for (int l = order; l < degrees; ++l)
      root(l - order, i) = coefficients[l] * weight * p[l - order];
  }
  const Eigen::MatrixXd gram = root * root.transpose();
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(gram, Eigen::EigenvaluesOnly).eigenvalues();
  std::vector<double> result;
  for (Eigen::Index i = values.size(); i-- > 0;) result.push_back(std::max(values[i], 0.0));
  return result;
}

std::vector<double> CapEigenvalues(const std::vector<double>& coefficients, double beta) {
  RequireCap(beta);
  const int degrees = SignificantDegrees(coefficients);
  const std::vector<double> kept(coefficients.begin(), coefficients.begin() + degrees);
  std::vector<std::vector<double>> orders(degrees);
  ParallelFor(0, degrees, [&](int64_t m) {
    orders[m] = CapEigenvaluesOfOrder(kept, beta, static_cast<int>(m));
  });
  double largest = 0;
  for (const auto& values : orders) largest = std::max(largest, values.front());
  std::vector<double> all;
  for (int m = 0; m < degrees; ++m) {
    for (const double value : orders[m]) {
      if (!(value > 1e-15 * largest)) break;
      all.insert(all.end(), m == 0 ? 1 : 2, value);
    }
  }
  std::sort(all.rbegin(), all.rend());
  return all;
}

std::vector<double> ScaledCoefficients(const std::vector<double>& g, double scale, int max_degree) {
  RequireDegree(max_degree);
  if (!(scale > 0 && std::isfinite(scale))) {
    throw Error("a function on the sphere cannot be scaled by " + std::to_string(scale));
  }
  const std::vector<double> kept(g.begin(), g.begin() + SignificantDegrees(g));
  const double end = std::min(kPi, kPi / scale);
  // In the angle: there h is smooth up to its end.
  const int nodes = std::max<int>(128, max_degree + static_cast<int>(scale * kept.size()));
  const Quadrature rule = GaussLegendre(nodes, 0, end);
  std::vector<double> coefficients(max_degree + 1);
  for (int i = 0; i < nodes; ++i) {
    const double theta = rule.nodes[i];
    const double value =
        2 * kPi * rule.weights[i] * std::sin(theta) * EvaluateZonal(kept, std::cos(scale * theta));
    const std::vector<double> p = Legendre(max_degree, std::cos(theta));
    for (int l = 0; l <= max_degree; ++l) coefficients[l] += value * p[l];
  }
  return coefficients;
}

std::vector<double> SquaredCoefficients(const std::vector<double>& coefficients) {
  std::vector<double> squared = coefficients;
  for (double& value : squared) value *= value;
  return squared;
}

std::vector<double> WithMultiplicity(const std::vector<double>& coefficients) {
  std::vector<double> all;
  for (size_t l = 0; l < coefficients.size(); ++l)
    all.insert(all.end(), 2 * l + 1, coefficients[l]);
  std::sort(all.rbegin(), all.rend());
  return all;
}

}  // namespace lfm
