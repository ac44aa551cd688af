// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/point_cloud.h"
#include "core/progress.h"
#include "core/triangle_mesh.h"

namespace lfm {

/// The closed surface of an object that stands on the platform (z = 0), from its cleaned points
/// (CleanPoints): consolidated, continued below the platform (ContinueBelowPlatform), screened
/// Poisson with octree `depth`, cut and capped at z = 0, repaired.
///
/// Cells are 1.1 * extent / 2^depth wide: 0.5 mm for 120 mm at depth 8. Confidence is 0 on the cap
/// and where no point with a like normal lies within two and a half cells or three spacings of
/// points; else in (0, 1]: that of the nearest points, less the farther they are. Normals are area
/// weighted.
///
/// When no closed manifold comes out, up to five more attempts follow, with the octree's cube moved
/// and at last coarser; each is a note in `progress`, which counts them and may interrupt between
/// two. Throws Error when the last attempt fails too, and at once for a failure that is ours
/// (kSystem).
TriangleMesh ReconstructSurface(const PointCloud& object, double spacing_mm, int depth,
                                Progress& progress);

}  // namespace lfm
