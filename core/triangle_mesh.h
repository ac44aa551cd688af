// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace lfm {

/// An indexed triangle mesh, in millimetres, counter-clockwise seen from outside.
///
/// Optional per-vertex data is either empty or as long as `vertices`.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;
  std::vector<Eigen::Vector3d> normals;  ///< unit, per vertex
  std::vector<float> confidence;         ///< per vertex; 0 where nothing was measured
  std::vector<Eigen::Vector3f> colors;   ///< per vertex, sRGB-coded [0, 1]
};

/// Facts about a mesh's topology.
struct MeshTopology {
  bool manifold = false;  ///< every edge has one or two triangles, every vertex one fan
  bool closed = false;    ///< every edge has exactly two triangles, oppositely oriented
  int components = 0;
  int64_t degenerate_triangles = 0;  ///< repeated indices or zero area
  int64_t boundary_edges = 0;
};
MeshTopology ExamineTopology(const TriangleMesh& mesh);

/// Throws Error, naming `where`, when an index is out of range, a coordinate is not finite, or the
/// mesh has no triangle.
void ValidateMesh(const TriangleMesh& mesh, const char* where);

/// Area-weighted unit normals; (0, 0, 1) at a vertex of no triangle or of zero total area.
std::vector<Eigen::Vector3d> ComputeVertexNormals(const TriangleMesh& mesh);
/// Unit normal of a triangle; zero vector when its area is zero.
Eigen::Vector3d TriangleNormal(const TriangleMesh& mesh, int triangle);
double TriangleArea(const TriangleMesh& mesh, int triangle);
/// Of all triangles (mm^2); 0 when there is none.
double TotalArea(const TriangleMesh& mesh);
/// Signed volume (mm^3), positive for a closed mesh oriented outwards.
double SignedVolume(const TriangleMesh& mesh);

/// For each vertex the triangles of its ring, as offsets into one list: ring of v is
/// `triangles[offsets[v] .. offsets[v + 1])`, in ascending order.
struct VertexRings {
  std::vector<int> offsets;
  std::vector<int> triangles;
  /// Those of one vertex; as long as this lives.
  std::span<const int> Ring(int64_t vertex) const {
    return std::span(triangles).subspan(offsets[vertex], offsets[vertex + 1] - offsets[vertex]);
  }
};
VertexRings ComputeVertexRings(const TriangleMesh& mesh);

/// For triangle t and its edge e (from corner e to corner e + 1 mod 3): the neighbour's triangle
/// index, or -1 at a boundary.
std::vector<Eigen::Vector3i> ComputeTriangleNeighbors(const TriangleMesh& mesh);

}  // namespace lfm
