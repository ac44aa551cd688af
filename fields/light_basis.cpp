// SPDX-License-Identifier: BSD-3-Clause
#include "fields/light_basis.h"

#include <Eigen/QR>
#include <algorithm>

#include "core/error.h"
#include "fields/hemispherical_harmonics.h"
#include "fields/polynomial_texture.h"

namespace lfm {
namespace {

// Functions by rising degree.
std::vector<int> ByDegree(LightBasis basis) {
  if (basis == LightBasis::kPolynomial) return {5, 3, 4, 0, 1, 2};
  std::vector<int> order;
  for (int l = 0; l * l < LightBasisTerms(basis); ++l) {
    order.push_back(l * l + l);
    for (int m = 1; m <= l; ++m) {
      order.push_back(l * l + l - m);
      order.push_back(l * l + l + m);
    }
  }
  return order;
}

// Gram and Schmidt with a second pass: the columns of `values` that add something.
std::vector<int> IndependentColumns(const Eigen::MatrixXd& values, const std::vector<int>& order) {
  std::vector<int> used;
  std::vector<Eigen::VectorXd> directions;
  for (int column : order) {
    Eigen::VectorXd rest = values.col(column);
    const double length = rest.norm();
    for (int pass = 0; pass < 2; ++pass) {
      for (const Eigen::VectorXd& direction : directions) {
        rest -= direction.dot(rest) * direction;
      }
    }
    const double left = rest.norm();
    if (!(length > 0) || !(left > kLeastIndependence * length)) continue;
    used.push_back(column);
    directions.push_back(rest / left);
  }
  std::sort(used.begin(), used.end());
  return used;
}

}  // namespace

const char* LightBasisName(LightBasis basis) {
  switch (basis) {
    case LightBasis::kPolynomial:
      return "PTM";
    case LightBasis::kHarmonics4:
      return "HSH 4";
    case LightBasis::kHarmonics9:
      return "HSH 9";
    default:
      return "HSH 16";
  }
}

int LightBasisTerms(LightBasis basis) {
  switch (basis) {
    case LightBasis::kPolynomial:
      return 6;
    case LightBasis::kHarmonics4:
      return 4;
    case LightBasis::kHarmonics9:
      return 9;
    default:
      return 16;
  }
}

Eigen::VectorXd LightBasisValues(LightBasis basis, const Eigen::Vector3d& local) {
  switch (basis) {
    case LightBasis::kPolynomial:
      return PolynomialTerms(local);
    case LightBasis::kHarmonics4:
      return HemisphericalHarmonics(2, local);
    case LightBasis::kHarmonics9:
      return HemisphericalHarmonics(3, local);
    default:
      return HemisphericalHarmonics(4, local);
  }
}

LightSolver MakeLightSolver(LightBasis basis, const LightFrame& frame,
                            const std::vector<Eigen::Vector3d>& to_lights) {
  if (to_lights.empty()) throw Error("light fit: there is no light");
  std::vector<int> lights;
  for (size_t i = 0; i < to_lights.size(); ++i) {
    if (frame.IsAbove(to_lights[i])) lights.push_back(static_cast<int>(i));
  }
  if (lights.empty()) {
    for (size_t i = 0; i < to_lights.size(); ++i) lights.push_back(static_cast<int>(i));
  }
  const auto count = static_cast<Eigen::Index>(lights.size());
  Eigen::MatrixXd values(count, LightBasisTerms(basis));
  for (Eigen::Index i = 0; i < count; ++i) {
    values.row(i) = LightBasisValues(basis, frame.Local(to_lights[lights[i]]));
  }
  LightSolver result;
  result.used = IndependentColumns(values, ByDegree(basis));
  const auto used_count = static_cast<Eigen::Index>(result.used.size());
  Eigen::MatrixXd reduced(count, used_count);
  for (Eigen::Index i = 0; i < used_count; ++i) reduced.col(i) = values.col(result.used[i]);
  const Eigen::MatrixXd inverse =
      reduced.colPivHouseholderQr().solve(Eigen::MatrixXd::Identity(count, count));
  result.solver = Eigen::MatrixXd::Zero(values.cols(), static_cast<Eigen::Index>(to_lights.size()));
  for (Eigen::Index i = 0; i < used_count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) {
      result.solver(result.used[i], lights[j]) = inverse(i, j);
    }
  }
  return result;
}

}  // namespace lfm
