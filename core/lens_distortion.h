// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace lfm {

/// The terms of the lens model (core/camera.h); T is double, or a number that carries derivatives.
template <typename T>
struct LensTerms {
  T k1, k2, k3;                             ///< radial
  T p1, p2;                                 ///< tangential
  T k4 = T(0.0), k5 = T(0.0), k6 = T(0.0);  ///< radial, below the line
};

/// Distorts normalised coordinates (x, y) = (X/Z, Y/Z) as core/camera.h states it: the one place
/// that holds the formula. Has a value everywhere, beyond a fold too; what is not finite stays so.
template <typename T>
Eigen::Matrix<T, 2, 1> DistortNormalized(const LensTerms<T>& lens, const T& x, const T& y) {
  const T r2 = x * x + y * y;
  const T radial = (1.0 + r2 * (lens.k1 + r2 * (lens.k2 + r2 * lens.k3))) /
                   (1.0 + r2 * (lens.k4 + r2 * (lens.k5 + r2 * lens.k6)));
  return {x * radial + 2.0 * lens.p1 * x * y + lens.p2 * (r2 + 2.0 * x * x),
          y * radial + lens.p1 * (r2 + 2.0 * y * y) + 2.0 * lens.p2 * x * y};
}

}  // namespace lfm
