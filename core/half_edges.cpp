// SPDX-License-Identifier: BSD-3-Clause
#include "core/half_edges.h"

#include <tuple>

namespace lfm {

std::vector<HalfEdge> SortedHalfEdges(const TriangleMesh& mesh) {
  std::vector<HalfEdge> half_edges;
  half_edges.reserve(mesh.triangles.size() * 3);
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int e = 0; e < 3; ++e) {
      half_edges.push_back(
          {mesh.triangles[t][e], mesh.triangles[t][(e + 1) % 3], static_cast<int>(t), e});
    }
  }
  std::sort(half_edges.begin(), half_edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::tuple(a.Low(), a.High(), a.Corner()) < std::tuple(b.Low(), b.High(), b.Corner());
  });
  return half_edges;
}

}  // namespace lfm
