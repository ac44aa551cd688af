// SPDX-License-Identifier: BSD-3-Clause
#include "fields/gauss_legendre.h"

#include <cmath>
#include <numbers>
#include <string>

#include "core/error.h"

namespace lfm {

Quadrature GaussLegendre(int count, double low, double high) {
  if (count < 1 || count > 20000) {
    throw Error("a quadrature of " + std::to_string(count) + " nodes is out of range");
  }
  if (!std::isfinite(low) || !std::isfinite(high) || !(low < high)) {
    throw Error("a quadrature needs an interval that is finite and not empty");
  }
  const double middle = 0.5 * (low + high), half = 0.5 * (high - low);
  Quadrature rule{std::vector<double>(count), std::vector<double>(count)};
  for (int i = 0; i < (count + 1) / 2; ++i) {
    // Newton's method from the asymptotic place of the root.
    double x = std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5)), slope = 1;
    for (int step = 0; step < 100; ++step) {
      double p = 1, before = 0;
      for (int l = 1; l <= count; ++l) {
        const double next = ((2 * l - 1) * x * p - (l - 1) * before) / l;
        before = p;
        p = next;
      }
      slope = count * (x * p - before) / (x * x - 1);
      const double change = p / slope;
      x -= change;
      if (std::abs(change) < 1e-15) break;
    }
    rule.nodes[i] = middle + half * x;
    rule.nodes[count - 1 - i] = middle - half * x;
    rule.weights[i] = rule.weights[count - 1 - i] = half * 2 / ((1 - x * x) * slope * slope);
  }
  return rule;
}

}  // namespace lfm
