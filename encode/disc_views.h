// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <memory>
#include <span>
#include <vector>

#include "resample/direction_map.h"

namespace lfm {

/// Brings view maps from a hemi-octahedral square, with a skirt or without, onto the paper's disc,
/// grid x grid texels each: the disc whose bilinear interpolation comes nearest to that of the
/// square, in the least squares sense over directions above the horizon on a lattice twice as fine
/// as the square's. Texels that no such direction reaches take the value of the square at their own
/// direction, those outside the disc that of the rim; a weight of 1e-3 draws all texels there, so
/// that the solution is unique.
///
/// A constant map stays what it is, to 1e-5. Near the horizon a texel of the disc spans many
/// degrees: what is lost there cannot be kept on a disc of this grid.
class DiscViews {
 public:
  DiscViews(int grid, DirectionMap from);
  /// `values`: grid^2 a channel, channels outer. May be called from many threads.
  std::vector<float> FromSquare(std::span<const float> values) const;

 private:
  using Matrix = Eigen::SparseMatrix<double>;
  Matrix right_side_;  // of the normal equations, from the square's values
  std::unique_ptr<Eigen::SimplicialLDLT<Matrix>> normal_;
};

}  // namespace lfm
