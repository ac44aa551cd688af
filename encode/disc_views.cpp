// SPDX-License-Identifier: BSD-3-Clause
#include "encode/disc_views.h"

#include <algorithm>

#include "core/error.h"
#include "resample/direction_map.h"

namespace lfm {
namespace {

constexpr double kRidge = 1e-3;

using Triplets = std::vector<Eigen::Triplet<double>>;

// The four texels and weights of a point of the unit square, corner-aligned.
void AddTap(int row, int grid, const Eigen::Vector2d& square, Triplets& taps) {
  const Eigen::Array2d at = square.array().max(0).min(1) * (grid - 1);
  const Eigen::Array2d cell = at.floor().min(grid - 2), f = at - cell;
  for (int dy = 0; dy < 2; ++dy) {
    for (int dx = 0; dx < 2; ++dx) {
      const double weight = (dx ? f.x() : 1 - f.x()) * (dy ? f.y() : 1 - f.y());
      const int texel = (static_cast<int>(cell.y()) + dy) * grid + static_cast<int>(cell.x()) + dx;
      if (weight > 0) taps.emplace_back(row, texel, weight);
    }
  }
}

}  // namespace

DiscViews::DiscViews(int grid, DirectionMap from) {
  const int texels = grid * grid, fine = 2 * grid - 1, directions = fine * fine;
  Triplets disc, square, own;
  for (int q = 0; q < directions; ++q) {
    const Eigen::Vector3d d = GridDirection(DirectionMap::kHemiOctahedral, fine, q);
    AddTap(q, grid, SquareFromDirection(DirectionMap::kOrthographic, d), disc);
    AddTap(q, grid, SquareFromDirection(from, d), square);
  }
  for (int texel = 0; texel < texels; ++texel) {
    const Eigen::Vector3d d = GridDirection(DirectionMap::kOrthographic, grid, texel);
    AddTap(texel, grid, SquareFromDirection(from, d), own);
  }
  const auto matrix = [texels](int rows, const Triplets& taps) {
    Matrix result(rows, texels);
    result.setFromTriplets(taps.begin(), taps.end());
    return result;
  };
  const Matrix on_disc = matrix(directions, disc);
  Matrix identity(texels, texels);
  identity.setIdentity();
  right_side_ = on_disc.transpose() * matrix(directions, square) + kRidge * matrix(texels, own);
  const Matrix normal = Matrix(on_disc.transpose() * on_disc) + kRidge * identity;
  normal_ = std::make_unique<Eigen::SimplicialLDLT<Matrix>>(normal);
  if (normal_->info() != Eigen::Success) {
    throw Error("view maps could not be brought onto the disc", ErrorKind::kSystem);
  }
}

std::vector<float> DiscViews::FromSquare(std::span<const float> values) const {
  const Eigen::Index texels = right_side_.cols();
  std::vector<float> result(values.size());
  for (size_t first = 0; first < values.size(); first += static_cast<size_t>(texels)) {
    const Eigen::VectorXd square =
        Eigen::Map<const Eigen::VectorXf>(values.data() + first, texels).cast<double>();
    const Eigen::VectorXd solved = normal_->solve(right_side_ * square);
    Eigen::Map<Eigen::VectorXf>(result.data() + first, texels) = solved.cast<float>();
  }
  return result;
}

}  // namespace lfm
