// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/half_edge_mesh.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace lfm {
namespace {

// Below this quality a triangle's normal is mostly noise.
constexpr double kSoundQuality = 0.05;

// Triangles around `moved` that do not contain `other`: how they change when `moved` goes to
// `position`.
bool RingAllows(const HalfEdgeMesh& mesh, OpenMesh::VertexHandle moved,
                OpenMesh::VertexHandle other, const Eigen::Vector3d& position,
                const CollapseLimits& limits) {
  const HalfEdges& topology = mesh.topology;
  for (auto it = topology.cvoh_iter(moved); it.is_valid(); ++it) {
    if (topology.is_boundary(*it)) continue;
    const auto v1 = topology.to_vertex_handle(*it);
    const auto v2 = topology.to_vertex_handle(topology.next_halfedge_handle(*it));
    if (v1 == other || v2 == other) continue;
    const Eigen::Vector3d &old = mesh.Position(moved), &b = mesh.Position(v1),
                          &c = mesh.Position(v2);
    if ((b - position).norm() > limits.max_edge_mm) return false;
    const double longest_2 =
        std::max({(b - old).squaredNorm(), (c - b).squaredNorm(), (old - c).squaredNorm()});
    if (longest_2 <= limits.negligible_mm * limits.negligible_mm) continue;
    const double old_quality = TriangleQuality(old, b, c);
    const double quality = TriangleQuality(position, b, c);
    // Where a triangle is bad already, a little worse is no reason to leave it for ever.
    if (quality < std::min(limits.min_quality, 0.8 * old_quality)) return false;
    if (quality < std::min(limits.worst_quality, old_quality)) return false;
    const Eigen::Vector3d before = AreaNormal(old, b, c), after = AreaNormal(position, b, c);
    const double cosine_limit = old_quality > kSoundQuality ? limits.min_normal_cosine : -1;
    if (before.dot(after) < cosine_limit * before.norm() * after.norm()) return false;
  }
  return true;
}

}  // namespace

HalfEdgeMesh MakeHalfEdgeMesh(const TriangleMesh& mesh) {
  HalfEdgeMesh result;
  result.positions = mesh.vertices;
  result.topology.reserve(mesh.vertices.size(), mesh.vertices.size() + mesh.triangles.size(),
                          mesh.triangles.size());
  std::vector<OpenMesh::VertexHandle> handles(mesh.vertices.size());
  for (auto& handle : handles) handle = result.topology.add_vertex(HalfEdges::Point(0, 0, 0));
  for (const Eigen::Vector3i& t : mesh.triangles) {
    if (!result.topology.add_face(handles[t[0]], handles[t[1]], handles[t[2]]).is_valid()) {
      throw Error("mesh: the triangles do not make an oriented manifold surface");
    }
  }
  return result;
}

TriangleMesh MakeTriangleMesh(const HalfEdgeMesh& mesh) {
  TriangleMesh result;
  std::vector<int> new_index(mesh.positions.size(), -1);
  const HalfEdges& topology = mesh.topology;
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    const OpenMesh::VertexHandle handle(static_cast<int>(v));
    if (topology.status(handle).deleted() || topology.is_isolated(handle)) continue;
    new_index[v] = static_cast<int>(result.vertices.size());
    result.vertices.push_back(mesh.positions[v]);
  }
  for (size_t f = 0; f < topology.n_faces(); ++f) {
    const OpenMesh::FaceHandle face(static_cast<int>(f));
    if (topology.status(face).deleted()) continue;
    auto corner = topology.cfv_iter(face);
    Eigen::Vector3i triangle;
    for (int k = 0; k < 3; ++k, ++corner) triangle[k] = new_index[corner->idx()];
    result.triangles.push_back(triangle);
  }
  return result;
}

double TriangleQuality(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                       const Eigen::Vector3d& c) {
  const double squares = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
  return squares > 0 ? 2 * std::sqrt(3.0) * AreaNormal(a, b, c).norm() / squares : 0;
}

bool MayCollapse(const HalfEdgeMesh& mesh, OpenMesh::HalfedgeHandle half_edge,
                 const Eigen::Vector3d& position, const CollapseLimits& limits) {
  // OpenMesh marks vertices while it looks, and so asks for a mesh that may change.
  HalfEdges& topology = const_cast<HalfEdges&>(mesh.topology);
  const auto from = topology.from_vertex_handle(half_edge);
  const auto to = topology.to_vertex_handle(half_edge);
  if (static_cast<int>(topology.valence(from) + topology.valence(to)) - 4 > limits.max_valence) {
    return false;
  }
  return topology.is_collapse_ok(half_edge) && RingAllows(mesh, from, to, position, limits) &&
         RingAllows(mesh, to, from, position, limits);
}

}  // namespace lfm
