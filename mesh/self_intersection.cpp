// SPDX-License-Identifier: BSD-3-Clause
// Includes CGAL's mesh processing, which is under GPL-3.
#include "mesh/self_intersection.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string>

#include "core/error.h"

namespace lfm {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

constexpr int kRounds = 12;

SurfaceMesh MakeSurfaceMesh(const TriangleMesh& mesh) {
  SurfaceMesh surface;
  surface.reserve(static_cast<uint32_t>(mesh.vertices.size()),
                  static_cast<uint32_t>(3 * mesh.triangles.size() / 2),
                  static_cast<uint32_t>(mesh.triangles.size()));
  for (const Eigen::Vector3d& v : mesh.vertices) {
    surface.add_vertex(Kernel::Point_3(v.x(), v.y(), v.z()));
  }
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector3i& c = mesh.triangles[t];
    const auto face = surface.add_face(SurfaceMesh::Vertex_index(static_cast<uint32_t>(c[0])),
                                       SurfaceMesh::Vertex_index(static_cast<uint32_t>(c[1])),
                                       SurfaceMesh::Vertex_index(static_cast<uint32_t>(c[2])));
    if (face == SurfaceMesh::null_face()) {
      throw Error("self-intersections: triangle " + std::to_string(t) +
                  " does not fit: the mesh is not an oriented manifold");
    }
  }
  return surface;
}

// Marks the corners of triangles that touch a marked vertex, `rings` times over.
std::vector<char> Widen(std::vector<char> marked, const TriangleMesh& mesh, int rings) {
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<char> wider = marked;
    for (const Eigen::Vector3i& t : mesh.triangles) {
      if (!marked[t[0]] && !marked[t[1]] && !marked[t[2]]) continue;
      for (int k = 0; k < 3; ++k) wider[t[k]] = 1;
    }
    marked = std::move(wider);
  }
  return marked;
}

void MoveToNeighbors(TriangleMesh& mesh, const std::vector<char>& marked) {
  std::vector<Eigen::Vector3d> sums(mesh.vertices.size(), Eigen::Vector3d::Zero());
  std::vector<int> counts(mesh.vertices.size(), 0);
  for (const Eigen::Vector3i& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      sums[t[k]] += mesh.vertices[t[(k + 1) % 3]];
      ++counts[t[k]];
    }
  }
  for (size_t v = 0; v < marked.size(); ++v) {
    if (!marked[v] || counts[v] == 0) continue;
    const double height = mesh.vertices[v].z();
    mesh.vertices[v] = 0.5 * mesh.vertices[v] + 0.5 * sums[v] / counts[v];
    if (height == 0) mesh.vertices[v].z() = 0;
  }
}

std::vector<char> CornersOf(const std::vector<std::pair<int, int>>& pairs,
                            const TriangleMesh& mesh) {
  std::vector<char> marked(mesh.vertices.size(), 0);
  for (const auto& [a, b] : pairs) {
    for (const int t : {a, b}) {
      for (int k = 0; k < 3; ++k) marked[mesh.triangles[t][k]] = 1;
    }
  }
  return marked;
}

}  // namespace

std::vector<std::pair<int, int>> FindSelfIntersections(const TriangleMesh& mesh) {
  ValidateMesh(mesh, "self-intersections");
  const SurfaceMesh surface = MakeSurfaceMesh(mesh);
  std::vector<std::pair<SurfaceMesh::Face_index, SurfaceMesh::Face_index>> found;
  CGAL::Polygon_mesh_processing::self_intersections<CGAL::Sequential_tag>(
      surface, std::back_inserter(found));
  std::vector<std::pair<int, int>> pairs;
  for (const auto& [a, b] : found) {
    const int i = static_cast<int>(a.idx()), j = static_cast<int>(b.idx());
    pairs.emplace_back(std::min(i, j), std::max(i, j));
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

Untangled RemoveSelfIntersections(const TriangleMesh& mesh, const LeavePair& leave) {
  TriangleMesh moved;
  moved.vertices = mesh.vertices;
  moved.triangles = mesh.triangles;
  std::vector<std::pair<int, int>> pairs = FindSelfIntersections(moved);
  Untangled best{moved, static_cast<int>(pairs.size())};
  for (int round = 0; round < kRounds; ++round) {
    if (leave) std::erase_if(pairs, [&](const auto& p) { return leave(p.first, p.second); });
    if (pairs.empty()) break;
    MoveToNeighbors(moved, Widen(CornersOf(pairs, mesh), mesh, round / 2));
    pairs = FindSelfIntersections(moved);
    if (static_cast<int>(pairs.size()) < best.left) best = {moved, static_cast<int>(pairs.size())};
  }
  return best;
}

}  // namespace lfm
