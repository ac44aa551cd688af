// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/plane_cut.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/error.h"
#include "mesh/contour_fill.h"
#include "mesh/nearest_points.h"

namespace lfm {
namespace {

struct OpenMeshPart {
  TriangleMesh mesh;
  std::map<int, int> next_on_contour;  ///< the directed boundary edges in the plane
};

// Vertices of the part that is kept: the old ones above, and one for each edge that is cut.
class CutVertices {
 public:
  CutVertices(const std::vector<Eigen::Vector3d>& vertices, TriangleMesh& part)
      : vertices_(vertices), part_(part), kept_(vertices.size(), -1) {}

  int Kept(int vertex) {
    if (kept_[vertex] < 0) {
      kept_[vertex] = static_cast<int>(part_.vertices.size());
      part_.vertices.push_back(vertices_[vertex]);
    }
    return kept_[vertex];
  }

  int Crossing(int a, int b) {
    if (a > b) std::swap(a, b);
    const auto [place, is_new] =
        crossings_.try_emplace((static_cast<uint64_t>(a) << 32) | static_cast<uint64_t>(b),
                               static_cast<int>(part_.vertices.size()));
    if (is_new) {
      const Eigen::Vector3d &p = vertices_[a], &q = vertices_[b];
      Eigen::Vector3d x = p + (p.z() / (p.z() - q.z())) * (q - p);
      x.z() = 0;
      part_.vertices.push_back(x);
    }
    return place->second;
  }

 private:
  const std::vector<Eigen::Vector3d>& vertices_;
  TriangleMesh& part_;
  std::vector<int> kept_;
  std::unordered_map<uint64_t, int> crossings_;
};

OpenMeshPart KeepAbove(const std::vector<Eigen::Vector3d>& vertices,
                       const std::vector<Eigen::Vector3i>& triangles) {
  OpenMeshPart part;
  CutVertices cut(vertices, part.mesh);
  const auto add = [&](int a, int b, int c) { part.mesh.triangles.emplace_back(a, b, c); };
  const auto contour = [&](int from, int to) {
    if (!part.next_on_contour.emplace(from, to).second) {
      throw Error("reconstruction: the surface is not manifold at the platform");
    }
  };
  for (const Eigen::Vector3i& t : triangles) {
    const int above =
        (vertices[t[0]].z() > 0) + (vertices[t[1]].z() > 0) + (vertices[t[2]].z() > 0);
    if (above == 0) continue;
    if (above == 3) {
      add(cut.Kept(t[0]), cut.Kept(t[1]), cut.Kept(t[2]));
      continue;
    }
    int first = 0;  // the corner that is alone on its side
    while ((vertices[t[first]].z() > 0) != (above == 1)) ++first;
    const int a = t[first], b = t[(first + 1) % 3], c = t[(first + 2) % 3];
    const int ab = cut.Crossing(a, b), ca = cut.Crossing(c, a);
    if (above == 1) {
      add(cut.Kept(a), ab, ca);
      contour(ab, ca);
    } else {
      add(ab, cut.Kept(b), cut.Kept(c));
      add(ab, cut.Kept(c), ca);
      contour(ca, ab);
    }
  }
  return part;
}

std::vector<std::vector<int>> TraceContours(std::map<int, int> next) {
  std::vector<std::vector<int>> contours;
  while (!next.empty()) {
    std::vector<int> contour;
    const int start = next.begin()->first;
    for (int at = start; contour.empty() || at != start;) {
      const auto found = next.find(at);
      if (found == next.end()) {
        throw Error("reconstruction: the surface is not closed at the platform");
      }
      contour.push_back(at);
      at = found->second;
      next.erase(found);
    }
    contours.push_back(std::move(contour));
  }
  return contours;
}

// Points inside the contours' box on a triangular lattice, none so near to the contour that it
// would make a sliver with an edge.
std::vector<Eigen::Vector3d> MakeLattice(const std::vector<Eigen::Vector3d>& contour,
                                         double spacing_mm) {
  const NearestPoints index(contour);
  Eigen::Vector2d low = contour.front().head<2>(), high = low;
  for (const Eigen::Vector3d& p : contour) {
    low = low.cwiseMin(p.head<2>());
    high = high.cwiseMax(p.head<2>());
  }
  std::vector<Eigen::Vector3d> lattice;
  const double step = 2 * spacing_mm, row_step = step * std::sqrt(0.75);
  for (int row = 0; low.y() + row * row_step < high.y(); ++row) {
    for (int column = 0; low.x() + column * step < high.x(); ++column) {
      const Eigen::Vector3d x(low.x() + (column + 0.5 * (row % 2)) * step, low.y() + row * row_step,
                              0);
      if (index.Find(x, 1).front().distance > 1.05 * spacing_mm) lattice.push_back(x);
    }
  }
  return lattice;
}

std::vector<Eigen::Vector2d> Flatten(const std::vector<Eigen::Vector3d>& points) {
  std::vector<Eigen::Vector2d> flat;
  for (const Eigen::Vector3d& p : points) flat.push_back(p.head<2>());
  return flat;
}

}  // namespace

TriangleMesh CutAtPlatform(const TriangleMesh& mesh, double spacing_mm) {
  const bool reaches_below = std::any_of(mesh.vertices.begin(), mesh.vertices.end(),
                                         [](const Eigen::Vector3d& v) { return v.z() < 0; });
  if (!reaches_below) return mesh;
  std::vector<Eigen::Vector3d> vertices = mesh.vertices;
  const double clearance = 0.1 * spacing_mm;
  for (Eigen::Vector3d& v : vertices) {
    if (std::abs(v.z()) < clearance) v.z() = v.z() >= 0 ? clearance : -clearance;
  }
  OpenMeshPart part = KeepAbove(vertices, mesh.triangles);
  if (part.next_on_contour.empty()) return std::move(part.mesh);

  const auto contours = TraceContours(part.next_on_contour);
  std::vector<int> of_plane;  // the part's vertex for each point of the plane, -1 while unused
  std::vector<Eigen::Vector3d> points;
  std::vector<std::vector<int>> contours_in_plane;
  for (const std::vector<int>& contour : contours) {
    std::vector<int>& in_plane = contours_in_plane.emplace_back();
    for (const int v : contour) {
      in_plane.push_back(static_cast<int>(of_plane.size()));
      of_plane.push_back(v);
      points.push_back(part.mesh.vertices[v]);
    }
  }
  const std::vector<Eigen::Vector3d> lattice = MakeLattice(points, spacing_mm);
  points.insert(points.end(), lattice.begin(), lattice.end());
  of_plane.resize(points.size(), -1);
  for (const Eigen::Vector3i& t : FillContours(Flatten(points), contours_in_plane)) {
    for (int k = 0; k < 3; ++k) {
      if (of_plane[t[k]] >= 0) continue;
      of_plane[t[k]] = static_cast<int>(part.mesh.vertices.size());
      part.mesh.vertices.push_back(points[t[k]]);
    }
    part.mesh.triangles.emplace_back(of_plane[t[0]], of_plane[t[2]], of_plane[t[1]]);
  }
  return std::move(part.mesh);
}

}  // namespace lfm
