// SPDX-License-Identifier: BSD-3-Clause
// Includes CGAL's mesh processing, which is under GPL-3.
#include "mesh/part_union.h"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <numeric>
#include <utility>
#include <vector>

#include "mesh/decimation.h"
#include "mesh/self_intersection.h"

namespace lfm {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

// Of the size of the whole: corners this near are one, which rounding pulled apart.
constexpr double kNoEdge_rel = 1e-9;

// The part of each vertex, and how many parts there are.
std::pair<std::vector<int>, int> LabelParts(const TriangleMesh& mesh) {
  std::vector<int> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Eigen::Vector3i& t : mesh.triangles) {
    for (const int corner : {t[1], t[2]}) parent[root(corner)] = root(t[0]);
  }
  std::vector<int> part_of_root(mesh.vertices.size(), -1), part(mesh.vertices.size(), -1);
  int count = 0;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    int& label = part_of_root[root(t[0])];
    if (label < 0) label = count++;
    for (int k = 0; k < 3; ++k) part[t[k]] = label;
  }
  return {std::move(part), count};
}

std::vector<TriangleMesh> SplitIntoParts(const TriangleMesh& mesh) {
  const auto [part, count] = LabelParts(mesh);
  std::vector<TriangleMesh> parts(count);
  std::vector<int> index(mesh.vertices.size(), -1);
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (part[v] < 0) continue;
    index[v] = static_cast<int>(parts[part[v]].vertices.size());
    parts[part[v]].vertices.push_back(mesh.vertices[v]);
  }
  for (const Eigen::Vector3i& t : mesh.triangles) {
    parts[part[t[0]]].triangles.emplace_back(index[t[0]], index[t[1]], index[t[2]]);
  }
  return parts;
}

bool EnclosesVolume(const TriangleMesh& part) {
  const MeshTopology topology = ExamineTopology(part);
  return topology.closed && topology.manifold && topology.degenerate_triangles == 0 &&
         SignedVolume(part) > 0;
}

// Whether the part is free of crossings, if need be after its small folds were smoothed.
bool Untangle(TriangleMesh& part) {
  Untangled untangled = RemoveSelfIntersections(part);
  part = std::move(untangled.mesh);
  return untangled.left == 0 && EnclosesVolume(part);
}

SurfaceMesh MakeSurfaceMesh(const TriangleMesh& mesh) {
  SurfaceMesh surface;
  for (const Eigen::Vector3d& v : mesh.vertices) {
    surface.add_vertex(Kernel::Point_3(v.x(), v.y(), v.z()));
  }
  for (const Eigen::Vector3i& t : mesh.triangles) {
    surface.add_face(SurfaceMesh::Vertex_index(static_cast<uint32_t>(t[0])),
                     SurfaceMesh::Vertex_index(static_cast<uint32_t>(t[1])),
                     SurfaceMesh::Vertex_index(static_cast<uint32_t>(t[2])));
  }
  return surface;
}

TriangleMesh MakeTriangleMesh(SurfaceMesh& surface) {
  surface.collect_garbage();
  TriangleMesh mesh;
  for (const auto v : surface.vertices()) {
    const Kernel::Point_3& p = surface.point(v);
    mesh.vertices.emplace_back(CGAL::to_double(p.x()), CGAL::to_double(p.y()),
                               CGAL::to_double(p.z()));
  }
  for (const auto f : surface.faces()) {
    Eigen::Vector3i triangle;
    int k = 0;
    for (const auto v : surface.vertices_around_face(surface.halfedge(f))) {
      if (k < 3) triangle[k++] = static_cast<int>(v.idx());
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

}  // namespace

std::optional<TriangleMesh> UniteParts(const TriangleMesh& mesh) {
  ValidateMesh(mesh, "union of parts");
  std::vector<TriangleMesh> parts = SplitIntoParts(mesh);
  if (parts.size() < 2 || !std::all_of(parts.begin(), parts.end(), EnclosesVolume) ||
      !std::all_of(parts.begin(), parts.end(), Untangle)) {
    return {};
  }
  // Small ones first: each union then costs what the part joined last is worth.
  std::stable_sort(parts.begin(), parts.end(), [](const TriangleMesh& a, const TriangleMesh& b) {
    return a.triangles.size() < b.triangles.size();
  });
  SurfaceMesh united = MakeSurfaceMesh(parts.front());
  try {
    for (size_t i = 1; i < parts.size(); ++i) {
      SurfaceMesh next = MakeSurfaceMesh(parts[i]);
      if (!pmp::corefine_and_compute_union(united, next, united)) return {};
    }
  } catch (const std::exception&) {  // no union is defined
    return {};
  }
  const TriangleMesh rounded = MakeTriangleMesh(united);
  TriangleMesh result = RemoveShortEdges(rounded, kNoEdge_rel * std::sqrt(TotalArea(rounded)));
  const MeshTopology topology = ExamineTopology(result);
  if (!topology.closed || !topology.manifold || !(SignedVolume(result) > 0)) return {};
  return result;
}

}  // namespace lfm
