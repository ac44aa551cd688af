// SPDX-License-Identifier: BSD-3-Clause
#include "encode/afx_frames.h"

#include <Eigen/Geometry>

namespace lfm {

std::vector<Eigen::Matrix3d> AutomaticAfxFrames(const TriangleMesh& mesh) {
  constexpr double kParallel_rel = 1e-6;
  std::vector<Eigen::Vector3d> edges(mesh.vertices.size(), Eigen::Vector3d::Zero());
  std::vector<uint8_t> has_edge(mesh.vertices.size(), 0);
  for (const Eigen::Vector3i& triangle : mesh.triangles) {
    for (const int vertex : triangle) {
      if (has_edge[vertex] != 0) continue;
      has_edge[vertex] = 1;
      edges[vertex] = mesh.vertices[triangle[0]] - mesh.vertices[triangle[1]];
    }
  }
  // e1 x e2 = (v2 - v1) x (v3 - v1): the sum is that of the area-weighted normals.
  const std::vector<Eigen::Vector3d> normals = ComputeVertexNormals(mesh);
  std::vector<Eigen::Matrix3d> frames;
  for (size_t v = 0; v < normals.size(); ++v) {
    const Eigen::Vector3d& z = normals[v];
    Eigen::Vector3d x = edges[v] - edges[v].dot(z) * z;
    if (!(x.norm() > kParallel_rel * edges[v].norm())) {
      int axis = 0;
      z.cwiseAbs().minCoeff(&axis);
      x = Eigen::Vector3d::Unit(axis) - z[axis] * z;
    }
    x.normalize();
    frames.emplace_back();
    frames.back() << x, x.cross(z), z;
  }
  return frames;
}

}  // namespace lfm
