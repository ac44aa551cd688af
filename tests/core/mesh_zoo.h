// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <numbers>

#include "core/triangle_mesh.h"

// Tiny meshes with known topology.

namespace lfm {

inline TriangleMesh Make(std::vector<Eigen::Vector3d> vertices,
                         std::vector<Eigen::Vector3i> triangles) {
  TriangleMesh mesh;
  mesh.vertices = std::move(vertices);
  mesh.triangles = std::move(triangles);
  return mesh;
}

inline TriangleMesh SingleTriangle() {
  return Make({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
}

inline TriangleMesh Tetrahedron() {
  return Make({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
              {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
}

inline TriangleMesh Octahedron() {
  return Make(
      {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}});
}

inline TriangleMesh Torus(int around, int across) {
  TriangleMesh mesh;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double a = 2 * std::numbers::pi * i / around, b = 2 * std::numbers::pi * j / across;
      const double r = 3 + std::cos(b);
      mesh.vertices.push_back({r * std::cos(a), r * std::sin(a), std::sin(b)});
      const auto at = [&](int p, int q) { return (p % around) * across + q % across; };
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

inline TriangleMesh WithoutLast(TriangleMesh mesh) {
  mesh.triangles.pop_back();
  return mesh;
}

inline TriangleMesh WithFlipped(TriangleMesh mesh, int triangle) {
  std::swap(mesh.triangles[triangle][1], mesh.triangles[triangle][2]);
  return mesh;
}

inline TriangleMesh Moved(TriangleMesh mesh, const Eigen::Vector3d& by) {
  for (Eigen::Vector3d& v : mesh.vertices) v += by;
  return mesh;
}

inline TriangleMesh Join(TriangleMesh a, const TriangleMesh& b) {
  const int offset = static_cast<int>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const Eigen::Vector3i& t : b.triangles) a.triangles.push_back(t.array() + offset);
  return a;
}

/// Two triangles that share a vertex only.
inline TriangleMesh BowTie() {
  return Make({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 3, 4}});
}

/// Three triangles at one edge.
inline TriangleMesh ThreeSheets() {
  return Make({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}},
              {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}});
}

/// A band of five quadrilaterals with a half turn: one side only, so no orientation is consistent.
inline TriangleMesh Moebius() {
  TriangleMesh mesh;
  constexpr int kSteps = 5;
  for (int i = 0; i < kSteps; ++i) {
    const double a = 2 * std::numbers::pi * i / kSteps;
    for (const double s : {-0.5, 0.5}) {
      const double r = 2 + s * std::cos(a / 2);
      mesh.vertices.push_back({r * std::cos(a), r * std::sin(a), s * std::sin(a / 2)});
    }
    const int p = 2 * i, q = p + 1;
    const bool last = i == kSteps - 1;
    const int p_next = last ? 1 : p + 2, q_next = last ? 0 : q + 2;
    mesh.triangles.push_back({p, p_next, q_next});
    mesh.triangles.push_back({p, q_next, q});
  }
  return mesh;
}

}  // namespace lfm
