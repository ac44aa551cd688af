// SPDX-License-Identifier: BSD-3-Clause
#include "tests/fields/random_relightable.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace lfm {
namespace {

// A multiple of 1/1024 in [-1, 1].
float Number(std::mt19937& random) {
  return static_cast<float>(static_cast<int>(random() % 2049) - 1024) / 1024;
}

Eigen::Vector3d SpiralDirection(int i, int count) {
  const double z = 1 - (2.0 * i + 1) / count, angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
  return Eigen::Vector3d(std::sqrt(1 - z * z) * std::cos(angle),
                         std::sqrt(1 - z * z) * std::sin(angle), z)
      .normalized();
}

void AddResiduals(int most, std::mt19937& random, ClusteredModel& m) {
  std::vector<float> values;
  std::vector<uint16_t> columns;
  const int count = std::min<int>(static_cast<int>(random() % (most + 1)), m.columns);
  const int first = static_cast<int>(random() % m.columns);
  for (int i = 0; i < count; ++i) {
    values.push_back(Number(random));
    columns.push_back(static_cast<uint16_t>((first + i) % m.columns));
  }
  std::sort(values.begin(), values.end(),
            [](float a, float b) { return std::abs(a) > std::abs(b); });
  m.residual_value.insert(m.residual_value.end(), values.begin(), values.end());
  m.residual_column.insert(m.residual_column.end(), columns.begin(), columns.end());
  m.first_residual.push_back(static_cast<int64_t>(m.residual_value.size()));
}

}  // namespace

RelightableModel RandomRelightable(const RandomRelightableShape& shape) {
  std::mt19937 random(shape.seed);
  RelightableModel r;
  r.name = "random";
  r.points = int64_t{shape.width} * shape.height;
  r.width = shape.width;
  r.height = shape.height;
  r.channels = shape.channels;
  for (int i = 0; i < shape.columns; ++i) {
    r.directions.push_back(SpiralDirection(i, shape.columns));
  }
  ClusteredModel& m = r.model;
  m.rows = r.points * r.channels;
  m.columns = shape.columns;
  for (int k = 0; k < shape.clusters; ++k) {
    FunctionRows basis =
        MakeFunctionRows(std::min(k % (shape.most_terms + 1), shape.columns), shape.columns);
    for (int64_t t = 0; t < basis.rows; ++t) {
      for (int i = 0; i < shape.columns; ++i) basis.Row(t)[i] = Number(random);
    }
    m.bases.push_back(std::move(basis));
  }
  m.first_residual.push_back(0);
  for (int64_t row = 0; row < m.rows; ++row) {
    m.cluster.push_back(static_cast<uint16_t>(random() % shape.clusters));
    m.first_weight.push_back(static_cast<int64_t>(m.weights.size()));
    for (int t = 0; t < m.Terms(row); ++t) m.weights.push_back(Number(random));
    AddResiduals(shape.most_residuals, random, m);
  }
  return r;
}

}  // namespace lfm
