// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace lfm {

/// Six square faces of n x n texels round a point, as light (Mahajan 2007 uses 6 x 32 x 32). Faces
/// in the order +x, -x, +y, -y, +z, -z; a texel's index is (face n + row) n + column. On the face
/// of axis a (sign s) with b, c the next two axes in cyclic order, columns run along +b and rows
/// along +c, both from -1 to 1: the direction is s a + p b + q c.
struct CubeMap {
  int resolution = 32;

  int Texels() const { return 6 * resolution * resolution; }

  /// Unnormalised direction, of which one coordinate is +-1, at (x, y) inside texel `index`;
  /// (0.5, 0.5) is its middle.
  Eigen::Vector3f Point(int index, float x, float y) const {
    const int face = index / (resolution * resolution), axis = face / 2;
    const int row = index / resolution % resolution, column = index % resolution;
    const float scale = 2 / static_cast<float>(resolution);
    Eigen::Vector3f d;
    d[axis] = face % 2 == 0 ? 1.0f : -1.0f;
    d[(axis + 1) % 3] = (static_cast<float>(column) + x) * scale - 1;
    d[(axis + 2) % 3] = (static_cast<float>(row) + y) * scale - 1;
    return d;
  }
  Eigen::Vector3f Direction(int index) const { return Point(index, 0.5f, 0.5f).normalized(); }

  /// The texel that a direction (any length but 0) falls into.
  int TexelOf(const Eigen::Vector3f& direction) const {
    const float x = std::abs(direction.x()), y = std::abs(direction.y());
    const float z = std::abs(direction.z());
    const int axis = x >= y ? (x >= z ? 0 : 2) : (y >= z ? 1 : 2);
    const float half = 0.5f * static_cast<float>(resolution), scale = half / std::max({x, y, z});
    const auto cell = [&](int other) {
      return std::clamp(static_cast<int>(scale * direction[other] + half), 0, resolution - 1);
    };
    const int face = 2 * axis + (direction[axis] < 0 ? 1 : 0);
    return (face * resolution + cell((axis + 2) % 3)) * resolution + cell((axis + 1) % 3);
  }

  /// Exact solid angle of a texel, sr; all together are 4 pi.
  double SolidAngle(int index) const {
    const double step = 2.0 / resolution;
    const double x = (index % resolution) * step - 1;
    const double y = (index / resolution % resolution) * step - 1;
    // Signed solid angle of the rectangle from the face's middle to (a, b).
    const auto corner = [](double a, double b) {
      return std::atan2(a * b, std::sqrt(a * a + b * b + 1));
    };
    return corner(x + step, y + step) - corner(x, y + step) - corner(x + step, y) + corner(x, y);
  }
};

}  // namespace lfm
