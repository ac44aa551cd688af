// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

namespace lfm {

/// Probability that a chi-square variable of `degrees` exceeds `x`: the regularised upper
/// incomplete gamma function Q(degrees / 2, x / 2), by its series or continued fraction (Abramowitz
/// and Stegun 6.5.29 and 6.5.31).
inline double ChiSquareTail(double x, double degrees) {
  const double a = degrees / 2, z = x / 2;
  if (z <= 0) return 1;
  const double front = std::exp(-z + a * std::log(z) - std::lgamma(a));
  if (z < a + 1) {
    double term = 1 / a, sum = term;
    for (double n = a + 1; term > 1e-15 * sum; ++n) sum += term *= z / n;
    return 1 - front * sum;
  }
  double b = z + 1 - a, c = 1e300, d = 1 / b, h = d;
  for (int i = 1; i < 10000; ++i) {
    const double an = -i * (i - a);
    b += 2;
    d = 1 / (an * d + b);
    c = b + an / c;
    h *= d * c;
    if (std::abs(d * c - 1) < 1e-14) break;
  }
  return front * h;
}

/// p-value of counts against expectations; bins expected below 8 are pooled.
inline double ChiSquareTest(const std::vector<double>& counts,
                            const std::vector<double>& expected) {
  double chi2 = 0, rest_counted = 0, rest_expected = 0;
  int bins = 0;
  const auto add = [&](double counted, double awaited) {
    chi2 += (counted - awaited) * (counted - awaited) / awaited;
    ++bins;
  };
  for (size_t b = 0; b < counts.size(); ++b) {
    if (expected[b] >= 8) {
      add(counts[b], expected[b]);
    } else {
      rest_counted += counts[b];
      rest_expected += expected[b];
    }
  }
  if (rest_expected >= 4) {
    add(rest_counted, rest_expected);
  } else if (rest_counted > 25) {
    return 0;  // samples where there should be none
  }
  return bins < 2 ? 1 : ChiSquareTail(chi2, bins - 1);
}

/// Samplers are tested at this significance, with fixed seeds: a right one would fail one seed in a
/// thousand.
inline constexpr double kSignificance = 1e-3;

}  // namespace lfm
