// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <map>
#include <span>
#include <vector>

namespace lfm {

/// The coefficients of the lowest `used` rows and columns, row-major.
struct LowFrequencies {
  int used = 0;
  std::vector<float> values;
  float& At(int row, int column) { return values[row * used + column]; }
  float At(int row, int column) const { return values[row * used + column]; }
};

/// What the inverse transforms work in; each thread has its own.
struct TransformBuffers {
  LowFrequencies mirrored;
  std::vector<float> rows, samples;
};

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

  /// n x n to n x n.
  Eigen::MatrixXf ToSquare(const Eigen::MatrixXf& samples) const;
  /// side x side samples, row-major. The coefficients of the lowest rows and columns are `low`, the
  /// others zero.
  void FromSquare(int side, const LowFrequencies& low, std::span<float> samples,
                  TransformBuffers& buffers) const;
  /// Samples in the order of PatchSampleIndex to an n x n matrix with row >= column filled, zero
  /// above.
  Eigen::MatrixXf ToTriangle(int n, std::span<const float> samples) const;
  /// Of `low` only row >= column is read.
  void FromTriangle(int n, const LowFrequencies& low, std::span<float> samples,
                    TransformBuffers& buffers) const;

 private:
  struct Basis {
    Eigen::MatrixXf cosines;    // rows
    std::vector<float> padded;  // the same, row-major, as kernels::InverseCosines takes it
  };
  const Basis& BasisOf(int side) const;
  void Invert(int side, const LowFrequencies& low, TransformBuffers& buffers) const;
  std::map<int, Basis> bases_;
};

/// Orthonormal opponent colours: columns gray, red - blue, green - magenta.
const Eigen::Matrix3f& OpponentColors();

}  // namespace lfm
