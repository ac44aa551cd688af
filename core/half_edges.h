// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

#include "core/triangle_mesh.h"

namespace lfm {

/// One side of an edge, as its triangle runs along it.
struct HalfEdge {
  int from = 0, to = 0;  ///< vertices
  int triangle = 0;
  int edge = 0;  ///< of the triangle, from its corner `edge` to the next

  int Low() const { return std::min(from, to); }
  int High() const { return std::max(from, to); }
  bool Forward() const { return from < to; }
  int Corner() const { return 3 * triangle + edge; }  ///< at which it starts
};

/// All half-edges of a mesh, those of one undirected edge together: ordered by lower and higher
/// vertex, then by triangle and edge. Indices are not checked.
std::vector<HalfEdge> SortedHalfEdges(const TriangleMesh& mesh);

/// True when two half-edges join the same vertices.
inline bool SameEdge(const HalfEdge& a, const HalfEdge& b) {
  return a.Low() == b.Low() && a.High() == b.High();
}

}  // namespace lfm
