// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace lfm {

/// integral of f over [low, high] ~ sum of weights[i] f(nodes[i]).
struct Quadrature {
  std::vector<double> nodes, weights;
};

/// Gauss-Legendre: exact for polynomials of degree 2 count - 1. Throws Error unless 1 <= count <=
/// 20000 and low < high are finite.
Quadrature GaussLegendre(int count, double low, double high);

}  // namespace lfm
