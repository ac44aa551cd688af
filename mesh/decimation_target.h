// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/progress.h"
#include "core/triangle_mesh.h"
#include "mesh/surface_distance.h"

namespace lfm {

/// How far two surfaces lie apart, by samples spread over each and their closest points on the
/// other.
struct SurfaceDeviation {
  DistanceStatistics from_mesh, from_surface;
  DistanceStatistics both;  ///< all distances together
  /// The 95 % distance of the worse direction, mm.
  double WorseP95() const { return std::max(from_mesh.p95, from_surface.p95); }
};
SurfaceDeviation MeasureDeviation(const TriangleMesh& mesh, const TriangleMesh& surface);

struct DecimatedMesh {
  TriangleMesh mesh;  ///< vertices and triangles only
  SurfaceDeviation deviation;
};

/// About `count` triangles (at most; never below 4), improved by ImproveTriangles. The surface
/// itself when it has no more than that.
DecimatedMesh DecimateToCount(const TriangleMesh& surface, int64_t count);

/// The coarsest mesh whose WorseP95() is at most `tolerance_mm`, by bisection over the number of
/// triangles to within 3 %; the surface itself when no coarser one is near enough.
DecimatedMesh DecimateToTolerance(const TriangleMesh& surface, double tolerance_mm,
                                  Progress& progress);

}  // namespace lfm
