// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/ray_scene.h"
#include "core/triangle_mesh.h"

namespace lfm {

/// Figures of a set of distances, mm. All zero when there are none (`samples` tells).
struct DistanceStatistics {
  int64_t samples = 0;
  double mean = 0, rms = 0, median = 0, p95 = 0, max = 0;  ///< mm
};

/// Quantiles interpolate linearly between order statistics. Throws Error when a distance is not
/// finite or negative.
DistanceStatistics SummarizeDistances(std::vector<double> distances_mm);

/// Points spread over a mesh by area, about `count`, deterministic by `seed`.
struct SurfaceSamples {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> normals;  ///< unit, of the triangle a point lies on
  std::vector<int> triangles;            ///< the triangle a point lies on
};

/// Stratified sampling: the surface is laid out triangle after triangle and cut into `count` pieces
/// of equal area; each gets one point, uniform in area. The number of points on a part of the
/// surface so differs from its share by little more than one a triangle. Independent of the number
/// of threads. `count` <= 0 gives no samples; triangles of zero area get none. Throws Error for an
/// invalid mesh or one whose total area is zero.
SurfaceSamples SampleSurface(const TriangleMesh& mesh, int64_t count, uint64_t seed);

/// Unsigned distances from points to the closest point of a mesh, mm; good to about 1e-6 of the
/// mesh's extent (core/ray_scene.h). Throws Error for an invalid mesh or a point that is not
/// finite.
std::vector<double> DistancesToMesh(const std::vector<Eigen::Vector3d>& points,
                                    const TriangleMesh& mesh);
/// The same to a mesh prepared once for many calls.
std::vector<double> DistancesToMesh(const std::vector<Eigen::Vector3d>& points,
                                    const RayScene& scene);

}  // namespace lfm
