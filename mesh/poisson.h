// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/point_cloud.h"
#include "core/triangle_mesh.h"

namespace lfm {

struct PoissonSettings {
  int depth = 8;            ///< of the octree
  double cube_scale = 1.1;  ///< the octree's cube, relative to the points' largest extent
  double samples_per_node = 1.5;
  double point_weight = 4;  ///< of interpolating the points against following their normals
};

/// Screened Poisson reconstruction (Kazhdan and Hoppe 2013), as in PCL: the surface whose
/// indicator's gradient fits the normals, triangles counter-clockwise seen from outside. Normals
/// count by their length. Runs on one thread: the sums of PCL's parallel loops depend on the number
/// of threads. Where cells of different size meet PCL sometimes leaves a cell open: repair the
/// result (RepairToClosedManifold). The process's standard output is shut while PCL works, since it
/// prints about those. Two calls at the same time run one after the other (PCL keeps its octree's
/// memory in a static pool). Throws Error when there
/// are no points, or no surface comes out.
TriangleMesh ReconstructPoisson(const PointCloud& points, const PoissonSettings& settings);

}  // namespace lfm
