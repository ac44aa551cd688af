// SPDX-License-Identifier: BSD-3-Clause
#include "resample/direction_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "resample/vertex_frame.h"

namespace lfm {
namespace {

/// The z of the lowest directions that a map holds.
double LowestZ(DirectionMap map) { return map == DirectionMap::kHemiOctahedralSkirt ? -kSkirt : 0; }

/// The direction itself when it lies above z = `lowest`, else its nearest there.
Eigen::Vector3d LiftTo(double lowest, const Eigen::Vector3d& d) {
  if (d.z() >= lowest) return d;
  const double radius = std::hypot(d.x(), d.y());
  if (radius == 0) return {0, 0, 1};
  const double scale = std::sqrt(1 - lowest * lowest) / radius;
  return {d.x() * scale, d.y() * scale, lowest};
}

/// The direction (t p.x, t p.y, z) with |p.x| t + |p.y| t + (z + kSkirt) / (1 + kSkirt) = t.
Eigen::Vector3d FromSkirtedSquare(double px, double py) {
  const double slope = (1 + kSkirt) * std::max(0.0, 1 - std::abs(px) - std::abs(py));
  const double a = px * px + py * py + slope * slope, b = slope * kSkirt;
  const double t = (b + std::sqrt(b * b + a * (1 - kSkirt * kSkirt))) / a;
  return Eigen::Vector3d(t * px, t * py, t * slope - kSkirt).normalized();
}

Eigen::Vector3d NormalOf(const TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& computed,
                         size_t vertex) {
  if (!mesh.normals.empty()) {
    const Eigen::Vector3d& given = mesh.normals[vertex];
    const double length = given.norm();
    if (std::isfinite(length) && length > 0) return given / length;
  }
  return computed[vertex];
}

/// A unit vector at right angles to z: `edge` projected, or the world axis least along z.
Eigen::Vector3d PerpendicularAxis(const Eigen::Vector3d& z, const Eigen::Vector3d& edge) {
  // Below this share of its length an edge's projection is mostly rounding.
  constexpr double kParallel_rel = 1e-6;
  const Eigen::Vector3d projected = edge - edge.dot(z) * z;
  if (projected.norm() > kParallel_rel * edge.norm()) return projected.normalized();
  int axis = 0;
  z.cwiseAbs().minCoeff(&axis);
  const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
  return (unit - unit.dot(z) * z).normalized();
}

}  // namespace

Eigen::Vector2d SquareFromDirection(DirectionMap map, const Eigen::Vector3d& direction_in_frame) {
  const double length = direction_in_frame.norm();
  if (!std::isfinite(length) || length == 0) return {0.5, 0.5};
  const double lowest = LowestZ(map);
  const Eigen::Vector3d d = LiftTo(lowest, direction_in_frame / length);
  if (map == DirectionMap::kOrthographic) return {(d.x() + 1) / 2, (d.y() + 1) / 2};
  const double height = (d.z() - lowest) / (1 - lowest);
  const double scale = 1 / (std::abs(d.x()) + std::abs(d.y()) + height);
  const double px = d.x() * scale, py = d.y() * scale;
  return {(px + py + 1) / 2, (px - py + 1) / 2};
}

Eigen::Vector3d DirectionFromSquare(DirectionMap map, const Eigen::Vector2d& square) {
  if (!square.allFinite()) return {0, 0, 1};
  const double u = 2 * std::clamp(square.x(), 0.0, 1.0) - 1;
  const double v = 2 * std::clamp(square.y(), 0.0, 1.0) - 1;
  if (map == DirectionMap::kOrthographic) {
    const double radius_squared = u * u + v * v;
    if (radius_squared >= 1) {
      const double radius = std::sqrt(radius_squared);
      return {u / radius, v / radius, 0};
    }
    return {u, v, std::sqrt(1 - radius_squared)};
  }
  const double px = (u + v) / 2, py = (u - v) / 2;
  if (map == DirectionMap::kHemiOctahedralSkirt) return FromSkirtedSquare(px, py);
  return Eigen::Vector3d(px, py, std::max(0.0, 1 - std::abs(px) - std::abs(py))).normalized();
}

Eigen::Vector3d GridDirection(DirectionMap map, int grid, int q) {
  const double step = 1.0 / (grid - 1);
  return DirectionFromSquare(map, {(q % grid) * step, (q / grid) * step});
}

Eigen::Matrix3d VertexFrame(const Eigen::Vector3d& z, const Eigen::Vector3d& edge) {
  const Eigen::Vector3d x = PerpendicularAxis(z, edge);
  Eigen::Matrix3d frame;
  frame.col(0) = x;
  frame.col(1) = z.cross(x).normalized();
  frame.col(2) = z;
  return frame;
}

std::vector<Eigen::Matrix3d> ComputeVertexFrames(const TriangleMesh& mesh) {
  const size_t count = mesh.vertices.size();
  std::vector<int> first_neighbor(count, -1);
  for (const Eigen::Vector3i& triangle : mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      int& first = first_neighbor[static_cast<size_t>(triangle[corner])];
      if (first < 0) first = triangle[(corner + 1) % 3];
    }
  }
  const std::vector<Eigen::Vector3d> computed = ComputeVertexNormals(mesh);
  std::vector<Eigen::Matrix3d> frames(count);
  for (size_t v = 0; v < count; ++v) {
    Eigen::Vector3d edge = Eigen::Vector3d::Zero();
    if (first_neighbor[v] >= 0) {
      edge = mesh.vertices[static_cast<size_t>(first_neighbor[v])] - mesh.vertices[v];
    }
    frames[v] = VertexFrame(NormalOf(mesh, computed, v), edge);
  }
  return frames;
}

}  // namespace lfm
