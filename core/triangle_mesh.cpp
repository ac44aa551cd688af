// SPDX-License-Identifier: BSD-3-Clause
#include "core/triangle_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "core/disjoint_sets.h"
#include "core/error.h"
#include "core/half_edges.h"

namespace lfm {
namespace {

// A vertex is manifold when its triangles form one fan: joining them over shared edges at the
// vertex leaves one group.
bool VerticesHaveOneFan(const TriangleMesh& mesh, const std::vector<HalfEdge>& edges) {
  DisjointSets corners(mesh.triangles.size() * 3);
  const auto corner_of = [&mesh](int triangle, int vertex) {
    for (int c = 0; c < 3; ++c) {
      if (mesh.triangles[triangle][c] == vertex) return triangle * 3 + c;
    }
    return triangle * 3;
  };
  for (size_t i = 0; i + 1 < edges.size(); ++i) {
    if (!SameEdge(edges[i], edges[i + 1])) continue;
    for (int vertex : {edges[i].from, edges[i].to}) {
      corners.Unite(corner_of(edges[i].triangle, vertex), corner_of(edges[i + 1].triangle, vertex));
    }
  }
  std::vector<int> fan(mesh.vertices.size(), -1);
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int c = 0; c < 3; ++c) {
      int& known = fan[mesh.triangles[t][c]];
      const int root = corners.Find(static_cast<int>(t) * 3 + c);
      if (known == -1) known = root;
      if (known != root) return false;
    }
  }
  return true;
}

}  // namespace

MeshTopology ExamineTopology(const TriangleMesh& mesh) {
  MeshTopology topology;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector3i& i = mesh.triangles[t];
    const bool repeated = i[0] == i[1] || i[1] == i[2] || i[2] == i[0];
    if (repeated || !(TriangleArea(mesh, static_cast<int>(t)) > 0)) ++topology.degenerate_triangles;
    if (repeated) return topology;
  }
  const std::vector<HalfEdge> edges = SortedHalfEdges(mesh);
  DisjointSets components(mesh.triangles.size());
  bool manifold = true, closed = !edges.empty();
  for (size_t i = 0; i < edges.size();) {
    size_t j = i + 1;
    while (j < edges.size() && SameEdge(edges[i], edges[j])) {
      components.Unite(edges[i].triangle, edges[j].triangle);
      ++j;
    }
    if (j - i > 2) manifold = false;
    if (j - i == 1) ++topology.boundary_edges;
    if (j - i == 2 && edges[i].from == edges[i + 1].from) manifold = false;
    i = j;
  }
  closed = closed && topology.boundary_edges == 0;
  topology.manifold = manifold && VerticesHaveOneFan(mesh, edges);
  topology.closed = closed && topology.manifold;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (components.Find(static_cast<int>(t)) == static_cast<int>(t)) ++topology.components;
  }
  return topology;
}

void ValidateMesh(const TriangleMesh& mesh, const char* where) {
  const auto fail = [where](const std::string& what) {
    throw Error(std::string(where) + ": " + what);
  };
  if (mesh.triangles.empty()) fail("the mesh has no triangle");
  for (const auto& p : mesh.vertices) {
    if (!p.allFinite()) fail("a vertex coordinate is not finite");
  }
  const int count = static_cast<int>(mesh.vertices.size());
  for (const auto& t : mesh.triangles) {
    if (t.minCoeff() < 0 || t.maxCoeff() >= count)
      fail("a triangle names a vertex that is not there");
  }
  const auto check_length = [&](size_t size, const char* what) {
    if (size != 0 && size != mesh.vertices.size()) {
      fail(std::string("there are not as many ") + what + " as vertices");
    }
  };
  check_length(mesh.normals.size(), "normals");
  check_length(mesh.confidence.size(), "confidence values");
  check_length(mesh.colors.size(), "colours");
}

std::vector<Eigen::Vector3d> ComputeVertexNormals(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3d> normals(mesh.vertices.size(), Eigen::Vector3d::Zero());
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d n = (mesh.vertices[t[1]] - mesh.vertices[t[0]])
                                  .cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
    for (int c = 0; c < 3; ++c) normals[t[c]] += n;
  }
  for (auto& n : normals) {
    const double length = n.norm();
    n = length > 0 ? Eigen::Vector3d(n / length) : Eigen::Vector3d::UnitZ();
  }
  return normals;
}

Eigen::Vector3d TriangleNormal(const TriangleMesh& mesh, int triangle) {
  const Eigen::Vector3i& t = mesh.triangles[triangle];
  const Eigen::Vector3d n =
      (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
  const double length = n.norm();
  return length > 0 ? Eigen::Vector3d(n / length) : Eigen::Vector3d::Zero();
}

double TriangleArea(const TriangleMesh& mesh, int triangle) {
  const Eigen::Vector3i& t = mesh.triangles[triangle];
  return 0.5 * (mesh.vertices[t[1]] - mesh.vertices[t[0]])
                   .cross(mesh.vertices[t[2]] - mesh.vertices[t[0]])
                   .norm();
}

double TotalArea(const TriangleMesh& mesh) {
  double area = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    area += TriangleArea(mesh, static_cast<int>(t));
  }
  return area;
}

double SignedVolume(const TriangleMesh& mesh) {
  if (mesh.vertices.empty()) return 0;
  const Eigen::Vector3d origin = mesh.vertices.front();
  double six_volumes = 0;
  for (const auto& t : mesh.triangles) {
    six_volumes += (mesh.vertices[t[0]] - origin)
                       .dot((mesh.vertices[t[1]] - origin).cross(mesh.vertices[t[2]] - origin));
  }
  return six_volumes / 6;
}

VertexRings ComputeVertexRings(const TriangleMesh& mesh) {
  VertexRings rings;
  rings.offsets.assign(mesh.vertices.size() + 1, 0);
  for (const auto& t : mesh.triangles) {
    for (int c = 0; c < 3; ++c) ++rings.offsets[t[c] + 1];
  }
  std::partial_sum(rings.offsets.begin(), rings.offsets.end(), rings.offsets.begin());
  rings.triangles.resize(mesh.triangles.size() * 3);
  std::vector<int> next(rings.offsets.begin(), rings.offsets.end() - 1);
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int c = 0; c < 3; ++c) {
      rings.triangles[next[mesh.triangles[t][c]]++] = static_cast<int>(t);
    }
  }
  return rings;
}

std::vector<Eigen::Vector3i> ComputeTriangleNeighbors(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3i> neighbors(mesh.triangles.size(), Eigen::Vector3i::Constant(-1));
  const std::vector<HalfEdge> edges = SortedHalfEdges(mesh);
  for (size_t i = 0; i + 1 < edges.size(); ++i) {
    if (!SameEdge(edges[i], edges[i + 1])) continue;
    neighbors[edges[i].triangle][edges[i].edge] = edges[i + 1].triangle;
    neighbors[edges[i + 1].triangle][edges[i + 1].edge] = edges[i].triangle;
  }
  return neighbors;
}

}  // namespace lfm
