// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/point_cloud.h"
#include "core/progress.h"
#include "core/triangle_mesh.h"
#include "mesh/free_space.h"
#include "mesh/method_choice.h"

namespace lfm {

struct ReconstructionSettings {
  SurfaceMethod method = SurfaceMethod::kAuto;
  int depth = 8;  ///< of the octree
};

struct ReconstructedSurface {
  TriangleMesh mesh;
  SurfaceMethod method = SurfaceMethod::kPoisson;  ///< that made it; never kAuto
  std::vector<std::string> reasons;                ///< why that one, one line each
  double cell_mm = 0;
  int64_t carved_points = 0;   ///< where scans bounded what was closed without data
  int self_intersections = 0;  ///< pairs of triangles that could not be parted
};

/// The closed surface of an object that stands on the platform (z = 0), from its cleaned points
/// (CleanPoints): consolidated, continued below the platform (ContinueBelowPlatform), made a solid
/// by the method that ChooseMethod names, cut and capped at z = 0, repaired, fitted to the points,
/// self-intersections parted. Poisson first makes the solid at half the resolution; where `free`
/// says that scans saw through it, the border is a constraint of the second run (FindCarvedBorder).
/// Where Poisson's surface does not close about the points it is tried in a roomier cube; with
/// kAuto, wrapping steps in when that fails too.
///
/// Cells are 1.1 * extent / 2^depth wide (0.5 mm for 120 mm at depth 8), in the roomier cube 1.6.
/// Confidence is 0 on the cap and where no point with a like normal lies within two and a half
/// cells or three spacings of points; else in (0, 1]: that of the nearest points, less the farther
/// they are. Normals are area weighted.
///
/// Throws Error when there are no points, or no method gives a closed manifold.
ReconstructedSurface ReconstructSurface(const PointCloud& object, double spacing_mm,
                                        const ReconstructionSettings& settings,
                                        const FreeSpace& free, Progress& progress);

}  // namespace lfm
