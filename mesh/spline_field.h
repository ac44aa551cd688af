// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace lfm {

/// A function over a cube as a sum of quadratic B-splines on nested regular grids:
///   f(p) = sum_d sum_i c_{d,i} B((x - x_i) / h_d) B((y - y_i) / h_d) B((z - z_i) / h_d),
/// with h_d = side / 2^d and x_i the middle of cell i. Only coefficients that are not zero need to
/// be listed. Beyond the cube's faces the coefficients are mirrored.
struct SplineField {
  struct Coefficient {
    int x = 0, y = 0, z = 0;  ///< cell, [0, 2^d)
    float value = 0;
  };
  std::vector<std::vector<Coefficient>> levels;  ///< one list a depth, from depth 0

  int Depth() const { return static_cast<int>(levels.size()) - 1; }
};

/// Evaluates a SplineField at the corners of its finest cells, one layer of equal z after the
/// other, so that memory grows with the square of the resolution only.
///
/// A B-spline of width h is a sum of those of width h / 2 with the weights 1/4, 3/4, 3/4, 1/4 along
/// each axis: coefficients are brought from each grid to the next finer one, exactly.
class SplineLayers {
 public:
  /// Throws Error when a cell lies outside the cube, or the field has no level.
  explicit SplineLayers(SplineField field);

  /// (2^depth + 1)^2 values at the corners with z index `k`, x fastest; k in [0, 2^depth]. Calls
  /// must not go back by more than one layer.
  std::vector<float> Corners(int k);

 private:
  struct Level {
    int size = 0;                               ///< cells a side
    std::vector<SplineField::Coefficient> own;  ///< ordered by z
    std::vector<int64_t> offsets;               ///< of layer z in `own`
    int kept_z[4] = {-1, -1, -1, -1};           ///< which layer a slot holds
    std::vector<float> kept[4];                 ///< coefficients of this and coarser levels
  };
  const std::vector<float>& Coefficients(int depth, int z);

  std::vector<Level> levels_;
};

}  // namespace lfm
