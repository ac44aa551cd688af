// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <vector>

#include "core/triangle_mesh.h"

namespace lfm {

struct HalfEdgeTraits : public OpenMesh::DefaultTraits {
  VertexAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
};
using HalfEdges = OpenMesh::TriMesh_ArrayKernelT<HalfEdgeTraits>;

/// A mesh that can be changed edge by edge: OpenMesh knows who neighbours whom, positions are ours
/// (double). Vertex i of the TriangleMesh it is made from keeps its number.
struct HalfEdgeMesh {
  HalfEdges topology;
  std::vector<Eigen::Vector3d> positions;

  const Eigen::Vector3d& Position(OpenMesh::VertexHandle v) const { return positions[v.idx()]; }
};

/// Throws Error when the triangles do not make an oriented 2-manifold (with or without boundary).
HalfEdgeMesh MakeHalfEdgeMesh(const TriangleMesh& mesh);
/// Vertices and triangles that are left, renumbered in order; vertices of no triangle go.
TriangleMesh MakeTriangleMesh(const HalfEdgeMesh& mesh);

/// 4 sqrt(3) area / (sum of squared edge lengths): 1 equilateral, 0 degenerate.
double TriangleQuality(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                       const Eigen::Vector3d& c);
/// Twice the area, along the normal.
inline Eigen::Vector3d AreaNormal(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                  const Eigen::Vector3d& c) {
  return (b - a).cross(c - a);
}

/// What a collapse of a half-edge (its start merges into its end) may do to the triangles around.
struct CollapseLimits {
  double min_quality = 0;        ///< of any triangle, unless it was hardly better before
  double worst_quality = 0;      ///< of any triangle, unless it was worse before
  double min_normal_cosine = 0;  ///< between a sound triangle's normals before and after
  double max_edge_mm = 0;        ///< of any edge that is moved
  double negligible_mm = 0;      ///< triangles with no longer edge may turn
  int max_valence = 0;
};
/// True when collapsing to `position` leaves a manifold and keeps the limits.
bool MayCollapse(const HalfEdgeMesh& mesh, OpenMesh::HalfedgeHandle half_edge,
                 const Eigen::Vector3d& position, const CollapseLimits& limits);

}  // namespace lfm
