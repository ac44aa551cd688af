// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/shapes/round_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/error.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;

int QuarterSegments(double radius, double edge_mm) {
  const double segments = std::max(2.0, std::round(0.5 * kPi * radius / edge_mm));
  RequireTriangleCount(16 * segments * segments);  // of the largest of the shapes
  return static_cast<int>(segments);
}

// A point of the unit disc for a point of the square [-1, 1]^2 (Shirley and Chiu 1997), lifted to
// the unit hemisphere by equal angles from the pole.
V3 DomePoint(double a, double b) {
  const double r = std::max(std::abs(a), std::abs(b));
  if (r == 0) return V3::UnitZ();
  double angle;
  if (std::abs(a) >= std::abs(b)) {
    angle = kPi / 4 * (b / a) + (a < 0 ? kPi : 0);
  } else {
    angle = kPi / 2 - kPi / 4 * (a / b) + (b < 0 ? kPi : 0);
  }
  const double polar = 0.5 * kPi * r;
  const double s = r == 1 ? 1 : std::sin(polar), c = r == 1 ? 0 : std::cos(polar);
  return {s * std::cos(angle), s * std::sin(angle), c};
}

// Meshes made of domes and flat discs (grids of (n + 1)^2 vertices), and of rings between them,
// all with 4 n vertices round the rim in the same order.
class RoundBuilder {
 public:
  explicit RoundBuilder(int n) : n_(n) {}

  // Returns the rim, counter-clockwise seen from +z. `height` scales z (0 gives a flat disc; the
  // disc keeps the dome's polar spacing), `turned` reverses triangles and normals.
  std::vector<int> AddDome(double radius, double height, bool turned) {
    const int first = static_cast<int>(shape_.mesh.vertices.size());
    for (int j = 0; j <= n_; ++j) {
      for (int i = 0; i <= n_; ++i) {
        const V3 d = DomePoint(2.0 * i / n_ - 1, 2.0 * j / n_ - 1);
        shape_.mesh.vertices.push_back(radius * V3(d.x(), d.y(), height * d.z()));
        const V3 normal = height == 0 ? V3(V3::UnitZ()) : V3(d.x(), d.y(), height * d.z());
        shape_.mesh.normals.push_back(turned ? V3(-normal) : normal);
      }
    }
    const auto at = [&](int i, int j) { return first + j * (n_ + 1) + i; };
    const bool flipped = turned != (height < 0);
    for (int j = 0; j < n_; ++j) {
      for (int i = 0; i < n_; ++i) {
        // The diagonal runs away from the middle, else the corners' triangles lie on the rim.
        const bool rising = (2 * i < n_) == (2 * j < n_);
        const int a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
        if (rising) {
          AddTriangle(a, b, c, flipped);
          AddTriangle(a, c, d, flipped);
        } else {
          AddTriangle(a, b, d, flipped);
          AddTriangle(b, c, d, flipped);
        }
      }
    }
    std::vector<int> rim;
    for (int i = 0; i < n_; ++i) rim.push_back(at(i, 0));
    for (int j = 0; j < n_; ++j) rim.push_back(at(n_, j));
    for (int i = n_; i > 0; --i) rim.push_back(at(i, n_));
    for (int j = n_; j > 0; --j) rim.push_back(at(0, j));
    return rim;
  }

  // A ring of vertices in z = 0 like `rim`, scaled to `radius`.
  std::vector<int> AddRing(const std::vector<int>& rim, double radius, const V3& normal) {
    std::vector<int> ring;
    for (int v : rim) {
      ring.push_back(static_cast<int>(shape_.mesh.vertices.size()));
      const V3 p = shape_.mesh.vertices[v];
      shape_.mesh.vertices.push_back(radius * V3(p.x(), p.y(), 0).normalized());
      shape_.mesh.normals.push_back(normal);
    }
    return ring;
  }

  // The strip between two rims; faces +z when `inner` lies inside `outer`.
  void Join(const std::vector<int>& inner, const std::vector<int>& outer, bool turned) {
    for (size_t i = 0; i < inner.size(); ++i) {
      const size_t k = (i + 1) % inner.size();
      AddTriangle(inner[i], outer[i], outer[k], turned);
      AddTriangle(inner[i], outer[k], inner[k], turned);
    }
  }

  Shape Take() { return std::move(shape_); }

 private:
  void AddTriangle(int a, int b, int c, bool turned) {
    shape_.mesh.triangles.emplace_back(a, turned ? c : b, turned ? b : c);
  }

  int n_;
  Shape shape_;
};

}  // namespace

Shape MakeEllipsoid(const V3& radii, double edge_mm) {
  const int n = QuarterSegments(radii.maxCoeff(), edge_mm);
  // The surface of an n x n x n lattice: each of its points is one vertex.
  std::vector<int> vertex((n + 1) * (n + 1) * (n + 1), -1);
  Shape shape;
  const auto at = [&](const Eigen::Vector3i& lattice) {
    int& index = vertex[(lattice.z() * (n + 1) + lattice.y()) * (n + 1) + lattice.x()];
    if (index < 0) {
      index = static_cast<int>(shape.mesh.vertices.size());
      V3 d;
      for (int c = 0; c < 3; ++c) d[c] = std::tan(kPi / 4 * (2.0 * lattice[c] / n - 1));
      d.normalize();
      shape.mesh.vertices.push_back(radii.cwiseProduct(d));
      shape.mesh.normals.push_back(d.cwiseQuotient(radii).normalized());
    }
    return index;
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
          int quad[4];
          for (int k = 0; k < 4; ++k) {
            Eigen::Vector3i lattice;
            lattice[axis] = side * n;
            lattice[(axis + 1) % 3] = i + (k == 1 || k == 2);
            lattice[(axis + 2) % 3] = j + (k >= 2);
            quad[k] = at(lattice);
          }
          if (side == 0) std::swap(quad[1], quad[3]);
          shape.mesh.triangles.emplace_back(quad[0], quad[1], quad[2]);
          shape.mesh.triangles.emplace_back(quad[0], quad[2], quad[3]);
        }
      }
    }
  }
  return shape;
}

Shape MakeHemisphere(double radius, double edge_mm) {
  RoundBuilder builder(2 * QuarterSegments(radius, edge_mm));
  const std::vector<int> rim = builder.AddDome(radius, 1, false);
  const std::vector<int> base = builder.AddDome(0.98 * radius, 0, true);
  builder.Join(base, rim, true);
  return builder.Take();
}

Shape MakeBowl(double radius, double thickness, double edge_mm) {
  if (!(thickness > 0 && thickness < radius)) {
    throw Error("a bowl needs a wall thinner than its radius");
  }
  RoundBuilder builder(2 * QuarterSegments(radius, edge_mm));
  const std::vector<int> inside = builder.AddDome(radius, -1, true);
  const std::vector<int> outside = builder.AddDome(radius + thickness, -1, false);
  const std::vector<int> lip_in = builder.AddRing(inside, radius + 0.1 * thickness, V3::UnitZ());
  const std::vector<int> lip_out = builder.AddRing(inside, radius + 0.9 * thickness, V3::UnitZ());
  builder.Join(inside, lip_in, false);
  builder.Join(lip_in, lip_out, false);
  builder.Join(lip_out, outside, false);
  return builder.Take();
}

}  // namespace lfm
