// SPDX-License-Identifier: BSD-3-Clause
#include "encode/map_transform.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "encode/map_kernels.h"
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
    if (bases_.contains(side)) continue;
    const int padded = kernels::PaddedSide(side);
    Basis& basis = bases_[side];
    basis.cosines = CosineBasis(side);
    basis.padded.assign(static_cast<size_t>(side) * padded, 0.F);
    for (int k = 0; k < side; ++k) {
      for (int i = 0; i < side; ++i) basis.padded[k * padded + i] = basis.cosines(k, i);
    }
  }
}

const MapTransform::Basis& MapTransform::BasisOf(int side) const {
  const auto found = bases_.find(side);
  if (found == bases_.end()) {
    throw Error("transform: this side was not prepared", ErrorKind::kSystem);
  }
  return found->second;
}

Eigen::MatrixXf MapTransform::ToSquare(const Eigen::MatrixXf& samples) const {
  const Eigen::MatrixXf& basis = BasisOf(static_cast<int>(samples.rows())).cosines;
  return basis * samples * basis.transpose();
}

void MapTransform::Invert(int side, const LowFrequencies& low, TransformBuffers& buffers) const {
  const auto padded = static_cast<size_t>(kernels::PaddedSide(side));
  buffers.rows.resize(low.used * padded);
  buffers.samples.resize(side * padded);
  kernels::InverseCosines(BasisOf(side).padded.data(), side, low.values.data(), low.used,
                          buffers.rows.data(), buffers.samples.data());
}

void MapTransform::FromSquare(int side, const LowFrequencies& low, std::span<float> samples,
                              TransformBuffers& buffers) const {
  Invert(side, low, buffers);
  const float* row = buffers.samples.data();
  for (int y = 0; y < side; ++y, row += kernels::PaddedSide(side)) {
    std::copy_n(row, side, samples.data() + static_cast<size_t>(y) * side);
  }
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

void MapTransform::FromTriangle(int n, const LowFrequencies& low, std::span<float> samples,
                                TransformBuffers& buffers) const {
  LowFrequencies& square = buffers.mirrored;
  square = low;
  for (int row = 0; row < low.used; ++row) {
    square.At(row, row) /= kHalfPower;
    for (int column = 0; column < row; ++column) {
      const float value = low.At(row, column);
      square.At(column, row) = (row + column) % 2 == 0 ? value : -value;
    }
  }
  Invert(n, square, buffers);
  const float* row = buffers.samples.data();
  for (int j = 0; j < n; ++j, row += kernels::PaddedSide(n)) {
    std::copy_n(row, n - j, samples.data() + PatchSampleIndex(n, 0, j));
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
