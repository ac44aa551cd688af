// SPDX-License-Identifier: BSD-3-Clause
#include "fields/hemispherical_harmonics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace lfm {
namespace {

constexpr double kPi = std::numbers::pi;

// P_lm(x) without the phase of Condon and Shortley: sine = sqrt(1 - x^2), exact at both ends.
double AssociatedLegendre(int l, int m, double x, double sine) {
  double current = 1;  // P_mm = (2m - 1)!! sine^m
  for (int i = 1; i <= m; ++i) current *= (2 * i - 1) * sine;
  double before = 0;
  for (int i = m + 1; i <= l; ++i) {
    const double next = ((2 * i - 1) * x * current - (i + m - 1) * before) / (i - m);
    before = current;
    current = next;
  }
  return current;
}

// Of the shifted functions over the hemisphere: sqrt((2l + 1) (l - m)! / (2 pi (l + m)!)).
double Norm(int l, int m) {
  double quotient = 1;
  for (int i = l - m + 1; i <= l + m; ++i) quotient *= i;
  return std::sqrt((2 * l + 1) / (2 * kPi * quotient));
}

}  // namespace

Eigen::VectorXd HemisphericalHarmonics(int bands, const Eigen::Vector3d& local) {
  if (bands < 1 || bands > 4) {
    throw Error("hemispherical harmonics: there are 1 to 4 bands", ErrorKind::kSystem);
  }
  const double cosine = std::clamp(local.z(), 0.0, 1.0);
  const double x = 2 * cosine - 1, sine = 2 * std::sqrt(cosine * (1 - cosine));
  const double phi = std::atan2(local.y(), local.x());
  Eigen::VectorXd terms(bands * bands);
  for (int l = 0; l < bands; ++l) {
    const int middle = l * l + l;
    terms[middle] = Norm(l, 0) * AssociatedLegendre(l, 0, x, sine);
    for (int m = 1; m <= l; ++m) {
      const double sign = m == 2 ? -1 : 1;
      const double value = sign * std::sqrt(2.0) * Norm(l, m) * AssociatedLegendre(l, m, x, sine);
      terms[middle - m] = value * std::cos(m * phi);
      terms[middle + m] = value * std::sin(m * phi);
    }
  }
  return terms;
}

}  // namespace lfm
