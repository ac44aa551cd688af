// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/shapes/shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "core/error.h"
#include "core/image.h"
#include "core/parallel.h"
#include "sample_data/isosurface.h"

namespace lfm {
namespace {

template <typename T>
void AppendOrDrop(std::vector<T>& all, size_t count, const std::vector<T>& other,
                  size_t other_count) {
  if (all.size() == count && other.size() == other_count) {
    all.insert(all.end(), other.begin(), other.end());
  } else {
    all.clear();
  }
}

// Drops separate pieces smaller than a few cells, and cavities: what the grid makes of features
// that it does not resolve. The largest piece stays.
void DropCrumbs(TriangleMesh& mesh, double smallest_volume) {
  std::vector<int> piece(mesh.vertices.size());
  std::iota(piece.begin(), piece.end(), 0);
  const auto root = [&piece](int v) {
    while (piece[v] != v) v = piece[v] = piece[piece[v]];
    return v;
  };
  for (const Eigen::Vector3i& t : mesh.triangles) {
    piece[root(t[1])] = root(t[0]);
    piece[root(t[2])] = root(t[0]);
  }
  std::vector<double> volume(mesh.vertices.size(), 0);
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const auto &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    volume[root(t[0])] += a.dot(b.cross(c)) / 6;
  }
  const double kept_volume =
      std::min(smallest_volume, *std::max_element(volume.begin(), volume.end()));
  std::vector<int> index(mesh.vertices.size(), -1);
  TriangleMesh kept;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (volume[root(static_cast<int>(v))] < kept_volume) continue;
    index[v] = static_cast<int>(kept.vertices.size());
    kept.vertices.push_back(mesh.vertices[v]);
    kept.normals.push_back(mesh.normals[v]);
  }
  for (const Eigen::Vector3i& t : mesh.triangles) {
    if (index[t[0]] >= 0) kept.triangles.emplace_back(index[t[0]], index[t[1]], index[t[2]]);
  }
  mesh = std::move(kept);
}

}  // namespace

void AppendShape(Shape& shape, const Shape& other, const Eigen::Vector3d& offset) {
  const size_t count = shape.mesh.vertices.size(), added = other.mesh.vertices.size();
  for (const Eigen::Vector3d& p : other.mesh.vertices) shape.mesh.vertices.push_back(p + offset);
  for (const Eigen::Vector3i& t : other.mesh.triangles) {
    shape.mesh.triangles.push_back(t + Eigen::Vector3i::Constant(static_cast<int>(count)));
  }
  AppendOrDrop(shape.mesh.normals, count, other.mesh.normals, added);
  AppendOrDrop(shape.mesh.colors, count, other.mesh.colors, added);
  AppendOrDrop(shape.uv, count, other.uv, added);
  AppendOrDrop(shape.paint, count, other.paint, added);
}

void RequireTriangleCount(double triangles) {
  constexpr double kMaxTriangles = 4e6;
  if (!(triangles <= kMaxTriangles)) {
    throw Error("the shape would have more than 4 million triangles; choose longer edges");
  }
}

Shape PolygoniseShape(const std::function<double(const Eigen::Vector3d&)>& function,
                      const Eigen::Vector3d& min, const Eigen::Vector3d& max, double edge_mm,
                      double max_gradient) {
  IsosurfaceGrid grid;
  grid.cell_mm = edge_mm;
  // Off the round numbers where flat faces lie: corners on the surface itself are ambiguous.
  grid.min = min - edge_mm * Eigen::Vector3d(2.31, 2.43, 2.37);
  grid.max = max + Eigen::Vector3d::Constant(2.5 * edge_mm);
  constexpr double kMaxCells = 4e8;
  if (!(((grid.max - grid.min) / edge_mm).prod() <= kMaxCells)) {
    throw Error("the shape's grid would have more than 400 million cells; choose longer edges");
  }
  // Where a cell catches the surface badly, another position of the grid does not.
  constexpr int kPositions = 4;
  for (int position = 1;; ++position) {
    try {
      Shape shape;
      shape.mesh = PolygoniseIsosurface(function, grid, max_gradient);
      DropCrumbs(shape.mesh, 4 * edge_mm * edge_mm * edge_mm);
      return shape;
    } catch (const Error&) {
      if (position == kPositions) throw;
    }
    grid.min -= edge_mm * Eigen::Vector3d(0.23, 0.19, 0.29);
  }
}

void PaintShape(Shape& shape, const std::function<Paint(const Eigen::Vector3d&)>& paint) {
  shape.paint.resize(shape.mesh.vertices.size());
  shape.mesh.colors.resize(shape.mesh.vertices.size());
  ParallelFor(
      0, static_cast<int64_t>(shape.paint.size()),
      [&](int64_t v) {
        shape.paint[v] = paint(shape.mesh.vertices[v]);
        for (int c = 0; c < 3; ++c) {
          shape.mesh.colors[v][c] = SrgbFromLinear(shape.paint[v].diffuse[c]);
        }
      },
      256);
}

}  // namespace lfm
