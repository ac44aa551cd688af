// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <map>
#include <span>

namespace lfm {

/// Discrete cosine transforms (type II, orthonormal) of maps on squares and on triangles.
///
/// A triangle of n samples an edge is half of a square that is symmetric about its antidiagonal:
/// (i, j) and (n - 1 - j, n - 1 - i) hold the same. Coefficient (q, p) of such a square is
/// (-1)^(p + q) times (p, q), so n (n + 1) / 2 of them say it all, as many as there are samples.
/// They are scaled so that squared sums agree with those of the samples but for the hypotenuse,
/// whose samples count half.
class MapTransform {
 public:
  /// Prepares the sides that will be asked for.
  explicit MapTransform(std::span<const int> sides);

  /// Row-major n x n to n x n.
  Eigen::MatrixXf ToSquare(const Eigen::MatrixXf& samples) const;
  /// `low` holds the coefficients of the lowest rows and columns, the others being zero.
  Eigen::MatrixXf FromSquare(int side, const Eigen::MatrixXf& low) const;
  /// Samples in the order of PatchSampleIndex to an n x n matrix with row >= column filled, zero
  /// above.
  Eigen::MatrixXf ToTriangle(int n, std::span<const float> samples) const;
  void FromTriangle(int n, const Eigen::MatrixXf& low, std::span<float> samples) const;

 private:
  const Eigen::MatrixXf& Basis(int side) const;
  std::map<int, Eigen::MatrixXf> bases_;  // rows are cosines
};

/// Orthonormal opponent colours: columns gray, red - blue, green - magenta.
const Eigen::Matrix3f& OpponentColors();

}  // namespace lfm
