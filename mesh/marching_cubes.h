// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "core/triangle_mesh.h"

namespace lfm {

/// Values of a function at the corners of a cube of n^3 cells: layer k holds (n + 1)^2 values, x
/// fastest. Asked for k = 0 .. n, once each, in order.
using LayerSource = std::function<std::vector<float>(int k)>;

/// The surface f = 0 by marching cubes (Lorensen and Cline 1987); f > 0 is inside. Vertices are in
/// units of cells from corner (0, 0, 0), on cell edges, where the cubic through four corners in a
/// row vanishes. Where a face of a cell has two inside corners across its diagonal, they count as
/// joined, the same way from both cells: the surface has no holes, unless it leaves the cube.
/// Pieces may touch in an edge (RepairToClosedManifold parts them). Triangles are counter-clockwise
/// seen from where f < 0. Values that are not finite count as outside.
TriangleMesh MarchCubes(int cells, const LayerSource& layers);

}  // namespace lfm
