// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/shapes/box_shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

int Segments(double length, double edge_mm) {
  return static_cast<int>(std::clamp(std::round(length / edge_mm), 1.0, 1e6));
}

// Six grids, one a face, joined by strips along the edges and a triangle at each corner.
class BoxBuilder {
 public:
  BoxBuilder(const V3& size, double bevel, double edge_mm)
      : half_(0.5 * size), flat_(half_ - V3::Constant(bevel)) {
    for (int axis = 0; axis < 3; ++axis) count_[axis] = Segments(2 * flat_[axis], edge_mm);
    RequireTriangleCount(Triangles());
  }

  double Triangles() const {
    const double x = count_[0], y = count_[1], z = count_[2];
    return 4 * (x * y + y * z + z * x) + 8 * (x + y + z) + 8;
  }

  Shape Build() {
    for (int axis = 0; axis < 3; ++axis) {
      for (int side = 0; side < 2; ++side) AddFace(axis, side);
    }
    for (int axis = 0; axis < 3; ++axis) {
      for (int sides = 0; sides < 4; ++sides) AddStrip(axis, sides & 1, sides >> 1);
    }
    for (int corner = 0; corner < 8; ++corner) AddCorner(corner & 1, corner >> 1 & 1, corner >> 2);
    return std::move(shape_);
  }

 private:
  static double Sign(int side) { return side ? 1 : -1; }

  int FaceVertex(int axis, int side, int i, int j) const {
    return first_[axis][side] + j * (count_[(axis + 1) % 3] + 1) + i;
  }

  void AddTriangle(int a, int b, int c, const V3& outward) {
    const auto& p = shape_.mesh.vertices;
    const bool turned = (p[b] - p[a]).cross(p[c] - p[a]).dot(outward) < 0;
    shape_.mesh.triangles.emplace_back(a, turned ? c : b, turned ? b : c);
  }

  void AddQuad(int a, int b, int c, int d, const V3& outward) {
    AddTriangle(a, b, c, outward);
    AddTriangle(a, c, d, outward);
  }

  void AddFace(int axis, int side) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const V3 normal = Sign(side) * V3::Unit(axis);
    first_[axis][side] = static_cast<int>(shape_.mesh.vertices.size());
    for (int j = 0; j <= count_[v]; ++j) {
      for (int i = 0; i <= count_[u]; ++i) {
        const double s = static_cast<double>(i) / count_[u], t = static_cast<double>(j) / count_[v];
        V3 p;
        p[axis] = Sign(side) * half_[axis];
        p[u] = (2 * s - 1) * flat_[u];
        p[v] = (2 * t - 1) * flat_[v];
        shape_.mesh.vertices.push_back(p + V3(0, 0, half_.z()));
        shape_.mesh.normals.push_back(normal);
        shape_.uv.emplace_back(static_cast<float>(s), static_cast<float>(t));
      }
    }
    for (int j = 0; j < count_[v]; ++j) {
      for (int i = 0; i < count_[u]; ++i) {
        AddQuad(FaceVertex(axis, side, i, j), FaceVertex(axis, side, i + 1, j),
                FaceVertex(axis, side, i + 1, j + 1), FaceVertex(axis, side, i, j + 1), normal);
      }
    }
  }

  // Along the edge between the faces of the two axes after `axis`.
  void AddStrip(int axis, int side_b, int side_c) {
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    const V3 outward = Sign(side_b) * V3::Unit(b) + Sign(side_c) * V3::Unit(c);
    // In the face of b the grid's axes are c, a; in that of c they are a, b.
    const int on_b = side_c ? count_[c] : 0, on_c = side_b ? count_[b] : 0;
    for (int i = 0; i < count_[axis]; ++i) {
      AddQuad(FaceVertex(b, side_b, on_b, i), FaceVertex(b, side_b, on_b, i + 1),
              FaceVertex(c, side_c, i + 1, on_c), FaceVertex(c, side_c, i, on_c), outward);
    }
  }

  void AddCorner(int x, int y, int z) {
    const int sides[3] = {x, y, z};
    int at[3];
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      at[axis] = FaceVertex(axis, sides[axis], sides[u] ? count_[u] : 0, sides[v] ? count_[v] : 0);
    }
    AddTriangle(at[0], at[1], at[2], V3(Sign(x), Sign(y), Sign(z)));
  }

  V3 half_, flat_;
  std::array<int, 3> count_ = {};
  int first_[3][2] = {};
  Shape shape_;
};

}  // namespace

Shape MakeBox(const V3& size, double bevel, double edge_mm) {
  if (!(bevel > 0 && 2 * bevel < size.minCoeff())) {
    throw Error("a box needs a bevel above 0 and below half its smallest size");
  }
  return BoxBuilder(size, bevel, edge_mm).Build();
}

Shape MakeRingWall(double inner_radius, double outer_radius, double height, double angle,
                   double bevel, double edge_mm) {
  if (!(inner_radius > 0 && outer_radius > inner_radius && angle > 0 &&
        angle < 2 * std::numbers::pi)) {
    throw Error("a ring wall needs 0 < inner radius < outer radius and an angle below 360 degrees");
  }
  const double middle = 0.5 * (inner_radius + outer_radius);
  Shape shape = MakeBox({angle * middle, outer_radius - inner_radius, height}, bevel, edge_mm);
  for (size_t v = 0; v < shape.mesh.vertices.size(); ++v) {
    V3& p = shape.mesh.vertices[v];
    V3& n = shape.mesh.normals[v];
    const double a = p.x() / middle, radius = middle + p.y();
    const V3 along(std::cos(a), -std::sin(a), 0), out(std::sin(a), std::cos(a), 0);
    p = radius * out + V3(0, 0, p.z());
    n = n.x() * along + n.y() * out + V3(0, 0, n.z());
  }
  return shape;
}

Shape MakeSheet(double width, double depth, double edge_mm) {
  const int nx = Segments(width, edge_mm), ny = Segments(depth, edge_mm);
  RequireTriangleCount(2.0 * nx * ny);
  Shape shape;
  for (int j = 0; j <= ny; ++j) {
    for (int i = 0; i <= nx; ++i) {
      const double s = static_cast<double>(i) / nx, t = static_cast<double>(j) / ny;
      shape.mesh.vertices.emplace_back((s - 0.5) * width, (t - 0.5) * depth, 0);
      shape.mesh.normals.emplace_back(0, 0, 1);
      shape.uv.emplace_back(static_cast<float>(s), static_cast<float>(t));
    }
  }
  const auto at = [&](int i, int j) { return j * (nx + 1) + i; };
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      shape.mesh.triangles.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      shape.mesh.triangles.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return shape;
}

Shape MakeBlockers(int count_x, int count_y, const V3& size, const Eigen::Vector2d& pitch,
                   double bevel, double edge_mm) {
  const Shape box = MakeBox(size, bevel, edge_mm);
  RequireTriangleCount(static_cast<double>(box.mesh.triangles.size()) * count_x * count_y);
  Shape shape;
  for (int j = 0; j < count_y; ++j) {
    for (int i = 0; i < count_x; ++i) {
      AppendShape(
          shape, box,
          {(i - 0.5 * (count_x - 1)) * pitch.x(), (j - 0.5 * (count_y - 1)) * pitch.y(), 0});
    }
  }
  return shape;
}

}  // namespace lfm
