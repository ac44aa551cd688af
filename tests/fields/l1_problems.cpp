// SPDX-License-Identifier: BSD-3-Clause
#include "tests/fields/l1_problems.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace lfm {
namespace {

class Uniform {
 public:
  explicit Uniform(uint32_t seed) : engine_(seed) {}
  double operator()(double least = 0, double most = 1) {
    return least + (most - least) * std::ldexp(static_cast<double>(engine_()), -32);
  }

 private:
  std::mt19937 engine_;
};

Eigen::Vector3d UpperDirection(Uniform& uniform) {
  const double z = uniform(), angle = uniform(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

}  // namespace

SpikedLowRank MakeSpikedLowRank(int rows, int columns, int terms, double spikes, uint32_t seed) {
  Uniform uniform(seed);
  SpikedLowRank result{MakeFunctionRows(rows, columns), MakeFunctionRows(terms, columns), 0};
  for (int t = 0; t < terms; ++t) {
    for (int j = 0; j < columns; ++j) result.basis.Row(t)[j] = static_cast<float>(uniform());
  }
  std::vector<double> weights(static_cast<size_t>(terms));
  for (int i = 0; i < rows; ++i) {
    for (double& weight : weights) weight = uniform();
    for (int j = 0; j < columns; ++j) {
      double value = uniform() < spikes ? uniform(-1, 1) : 0;
      result.spike_error += std::abs(value);
      for (int t = 0; t < terms; ++t) value += weights[t] * result.basis.Row(t)[j];
      result.matrix.Row(i)[j] = static_cast<float>(value);
    }
  }
  return result;
}

FunctionRows MakeReflectanceLike(int rows, int columns, uint32_t seed) {
  Uniform uniform(seed);
  std::vector<Eigen::Vector3d> lights;
  for (int j = 0; j < columns; ++j) lights.push_back(UpperDirection(uniform));
  FunctionRows result = MakeFunctionRows(rows, columns);
  for (int i = 0; i < rows; ++i) {
    const Eigen::Vector3d normal =
        (UpperDirection(uniform) + Eigen::Vector3d::UnitZ()).normalized();
    const double diffuse = uniform(), specular = uniform(0, 0.5), exponent = uniform(20, 120);
    const double angle = uniform(0, 2 * std::numbers::pi), edge = uniform();
    for (int j = 0; j < columns; ++j) {
      const double cosine = normal.dot(lights[j]);
      const Eigen::Vector3d half = (lights[j] + Eigen::Vector3d::UnitZ()).normalized();
      double value = cosine > 0 ? diffuse * cosine : 0;
      if (cosine > 0) value += specular * std::pow(std::max(normal.dot(half), 0.0), exponent);
      const bool dark = lights[j].x() * std::cos(angle) + lights[j].y() * std::sin(angle) > edge;
      value = (dark ? 0.1 : 1.0) * value + uniform(-1e-3, 1e-3);
      result.Row(i)[j] = static_cast<float>(std::max(value, 0.0));
    }
  }
  return result;
}

FunctionRows MakeNoise(int rows, int columns, uint32_t seed) {
  Uniform uniform(seed);
  FunctionRows result = MakeFunctionRows(rows, columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) result.Row(i)[j] = static_cast<float>(uniform(-1, 1));
  }
  return result;
}

Eigen::MatrixXd ToDense(RowsView matrix) {
  Eigen::MatrixXd dense(matrix.rows, matrix.columns);
  for (int64_t i = 0; i < matrix.rows; ++i) {
    for (int j = 0; j < matrix.columns; ++j) dense(i, j) = matrix.Row(i)[j];
  }
  return dense;
}

double LeastErrorByTrying(RowsView basis, const float* target, ResidualSign sign) {
  const Eigen::MatrixXd functions = ToDense(basis);
  const Eigen::VectorXd b = Eigen::Map<const Eigen::VectorXf>(target, basis.columns).cast<double>();
  const int terms = static_cast<int>(basis.rows), columns = basis.columns;
  double least = std::numeric_limits<double>::infinity();
  for (uint32_t chosen = 0; chosen < uint32_t{1} << columns; ++chosen) {
    if (__builtin_popcount(chosen) != terms) continue;
    std::vector<int> met;
    for (int j = 0; j < columns; ++j) {
      if (chosen >> j & 1) met.push_back(j);
    }
    const Eigen::FullPivLU<Eigen::MatrixXd> square(functions(Eigen::all, met).transpose());
    if (!square.isInvertible()) continue;
    const Eigen::VectorXd rest = b - functions.transpose() * square.solve(b(met));
    if (sign == ResidualSign::kPositive && rest.minCoeff() < -1e-9) continue;
    least = std::min(least, rest.cwiseAbs().sum());
  }
  return least;
}

}  // namespace lfm
