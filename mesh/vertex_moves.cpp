// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/vertex_moves.h"

namespace lfm {

std::vector<Eigen::Vector3d> MoveWithoutFlips(const TriangleMesh& mesh,
                                              const std::vector<Eigen::Vector3d>& directions,
                                              Eigen::VectorXd moves) {
  constexpr double kLargestTurnCosine = 0.7;
  TriangleMesh moved = mesh;
  constexpr int kHalvings = 8;
  for (int attempt = 0; attempt <= kHalvings; ++attempt) {
    for (size_t v = 0; v < mesh.vertices.size(); ++v) {
      moved.vertices[v] = mesh.vertices[v] + moves[static_cast<Eigen::Index>(v)] * directions[v];
    }
    bool held_back = false;
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
      const int index = static_cast<int>(t);
      if (TriangleNormal(mesh, index).dot(TriangleNormal(moved, index)) > kLargestTurnCosine) {
        continue;
      }
      for (int k = 0; k < 3; ++k) {
        double& move = moves[mesh.triangles[t][k]];
        held_back |= move != 0;
        move = attempt + 1 < kHalvings ? 0.5 * move : 0;
      }
    }
    if (!held_back) return moved.vertices;
  }
  return mesh.vertices;
}

}  // namespace lfm
