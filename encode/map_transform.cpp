// SPDX-License-Identifier: BSD-3-Clause
#include "encode/map_transform.h"

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "resample/light_field.h"

namespace lfm {
namespace {

Eigen::MatrixXf CosineBasis(int side) {
  Eigen::MatrixXf basis(side, side);
  for (int k = 0; k < side; ++k) {
    const double scale = std::sqrt((k == 0 ? 1.0 : 2.0) / side);
    for (int i = 0; i < side; ++i) {
      basis(k, i) =
          static_cast<float>(scale * std::cos(std::numbers::pi * (2 * i + 1) * k / (2.0 * side)));
    }
  }
  return basis;
}

const float kHalfPower = std::sqrt(0.5F);

}  // namespace

MapTransform::MapTransform(std::span<const int> sides) {
  for (const int side : sides) {
    if (!bases_.contains(side)) bases_.emplace(side, CosineBasis(side));
  }
}

const Eigen::MatrixXf& MapTransform::Basis(int side) const {
  const auto found = bases_.find(side);
  if (found == bases_.end()) {
    throw Error("transform: this side was not prepared", ErrorKind::kSystem);
  }
  return found->second;
}

Eigen::MatrixXf MapTransform::ToSquare(const Eigen::MatrixXf& samples) const {
  const Eigen::MatrixXf& basis = Basis(static_cast<int>(samples.rows()));
  return basis * samples * basis.transpose();
}

Eigen::MatrixXf MapTransform::FromSquare(int side, const Eigen::MatrixXf& low) const {
  const auto basis = Basis(side).topRows(low.rows());
  return basis.transpose() * (low * basis).eval();
}

Eigen::MatrixXf MapTransform::ToTriangle(int n, std::span<const float> samples) const {
  Eigen::MatrixXf square(n, n);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i + j < n; ++i) {
      const float value = samples[PatchSampleIndex(n, i, j)];
      square(j, i) = value;
      square(n - 1 - i, n - 1 - j) = value;
    }
  }
  Eigen::MatrixXf coefficients = ToSquare(square);
  coefficients.diagonal() *= kHalfPower;
  coefficients.triangularView<Eigen::StrictlyUpper>().setZero();
  return coefficients;
}

void MapTransform::FromTriangle(int n, const Eigen::MatrixXf& low, std::span<float> samples) const {
  Eigen::MatrixXf full = low;
  full.diagonal() /= kHalfPower;
  for (int row = 0; row < static_cast<int>(low.rows()); ++row) {
    for (int column = 0; column < row; ++column) {
      full(column, row) = (row + column) % 2 == 0 ? full(row, column) : -full(row, column);
    }
  }
  const Eigen::MatrixXf square = FromSquare(n, full);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i + j < n; ++i) samples[PatchSampleIndex(n, i, j)] = square(j, i);
  }
}

const Eigen::Matrix3f& OpponentColors() {
  static const Eigen::Matrix3f colors = [] {
    Eigen::Matrix3f m;
    m.col(0) = Eigen::Vector3f(1, 1, 1).normalized();
    m.col(1) = Eigen::Vector3f(1, 0, -1).normalized();
    m.col(2) = Eigen::Vector3f(-1, 2, -1).normalized();
    return m;
  }();
  return colors;
}

}  // namespace lfm
