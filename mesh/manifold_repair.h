// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/triangle_mesh.h"

namespace lfm {

/// Makes a closed, oriented 2-manifold of a mesh that nearly is one.
///
/// Triangles with repeated corners go; two triangles with the same corners cancel. Small holes (at
/// most 32 edges: cells that marching cubes could not close) are filled by fans. Where four or
/// more triangles meet in an edge, those that bound the same wedge of solid stay together and the
/// rest gets vertices of its own; so do the fans of a vertex where several meet. Of the pieces that
/// come out, those with less than 2 % of the largest's volume go (crumbs, and hollows inside, whose
/// volume is negative). The surface is turned right side out. Unused vertices go. Only vertices and
/// triangles are returned.
///
/// Throws Error for a larger hole, or when nothing is left that bounds a volume.
TriangleMesh RepairToClosedManifold(const TriangleMesh& mesh);

/// A mesh of those triangles only whose entry in `keep` is not 0; unused vertices go. Per-vertex
/// data is kept.
TriangleMesh SelectTriangles(const TriangleMesh& mesh, const std::vector<char>& keep);

}  // namespace lfm
