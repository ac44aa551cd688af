// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "core/triangle_mesh.h"

namespace lfm {

/// Pairs of triangles that meet elsewhere than in the corners and edges that they share, ascending;
/// a triangle without area is paired with itself. Exact predicates (CGAL). Throws Error for an
/// invalid mesh or one that is not an oriented manifold.
std::vector<std::pair<int, int>> FindSelfIntersections(const TriangleMesh& mesh);

struct Untangled {
  TriangleMesh mesh;  ///< vertices and triangles only
  int left = 0;       ///< pairs that could not be parted
};

/// Which pairs of triangles, of those that meet, are to be left as they are.
using LeavePair = std::function<bool(int, int)>;

/// Parts triangles that meet: the vertices about them, in rings that widen from round to round, go
/// halfway to the middle of their neighbours, at most twelve rounds, of which the one that leaves
/// the fewest pairs counts: where nothing can be parted, nothing moves. Vertices at z = 0 keep that
/// height. Everything else stays as it is; the triangles' number and joints too. Pairs that `leave`
/// names stay and are counted.
Untangled RemoveSelfIntersections(const TriangleMesh& mesh, const LeavePair& leave = {});

}  // namespace lfm
