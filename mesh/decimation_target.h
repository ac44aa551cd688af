// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

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

/// What is decimated.
struct DecimationSource {
  // NOLINTNEXTLINE(google-explicit-constructor): a surface alone is the usual source.
  DecimationSource(const TriangleMesh& the_surface, std::vector<double> the_prices = {})
      : surface(the_surface), prices(std::move(the_prices)) {}
  const TriangleMesh& surface;
  std::vector<double> prices;  ///< of its vertices (Decimation), or empty
};

struct DecimatedMesh {
  TriangleMesh mesh;  ///< vertices and triangles only
  SurfaceDeviation deviation;
  double proven_error_mm =
      0;  ///< DecimateToMaxError: no point of either lies farther from the other
  int self_intersections = 0;  ///< pairs of triangles that could not be parted
};

/// About `count` triangles (at most; never below 4), improved by ImproveTriangles. The surface
/// itself when it has no more than that.
DecimatedMesh DecimateToCount(const DecimationSource& source, int64_t count);

/// What the searches below tell Progress that they take; few take more.
constexpr int kUsualAttempts = 7;

/// The coarsest mesh whose WorseP95() is at most `tolerance_mm`, by false position over the
/// number of triangles to within 3 %; the surface itself when no coarser one is near enough. More
/// pairs of triangles that cross than the surface has are never near enough.
DecimatedMesh DecimateToTolerance(const DecimationSource& source, double tolerance_mm,
                                  Progress& progress);

/// The coarsest mesh of which no point lies farther than `max_mm` from the surface, nor a point of
/// the surface farther from it: proven (IsWithin), not sampled. The surface itself when no coarser
/// one is near enough. Searched as above.
DecimatedMesh DecimateToMaxError(const DecimationSource& source, double max_mm, Progress& progress);

/// The mesh whose `measure` (which falls when triangles become more, about like 1 / count) comes
/// nearest to `target`: at most eight attempts from `guess` triangles on, until within 1.5 %. Never
/// so few triangles that a tenth of the surface's area is lost, if an attempt finds any with more.
DecimatedMesh DecimateToMean(const DecimationSource& source, int64_t guess, double target,
                             const std::function<double(const TriangleMesh&)>& measure,
                             Progress& progress);

}  // namespace lfm
