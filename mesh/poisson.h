// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "core/point_cloud.h"
#include "core/triangle_mesh.h"

namespace lfm {

struct PoissonSettings {
  int depth = 8;            ///< of the octree
  double cube_scale = 1.1;  ///< the octree's cube, relative to the points' largest extent
  double samples_per_node = 1.5;
  double point_weight = 4;  ///< of interpolating the points against following their normals
  /// Where the surface leaves the cube it is closed at the cube's walls. Below this height (where
  /// it is cut off later) that may be as much as it likes; above, at most a tenth of its area.
  double closed_below_mm = -std::numeric_limits<double>::infinity();
};

/// Screened Poisson reconstruction (Kazhdan and Hoppe 2013): the surface whose indicator's gradient
/// fits the normals. Normals count by their length. PCL's octree solves for the indicator, on one
/// thread: the sums of its parallel loops depend on the number of threads. The surface is taken out
/// by MarchCubes on the regular grid of the finest depth: PCL's own extraction leaves holes where
/// cells of different size meet. It is closed. Memory: the
/// octree, and layers of 4^depth values. Two calls at the same time run one after the other (PCL
/// keeps its octree's memory in a static pool). Throws Error when there are no points, or no
/// surface comes out.
TriangleMesh ReconstructPoisson(const PointCloud& points, const PoissonSettings& settings);

}  // namespace lfm
