// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/triangle_mesh.h"

namespace lfm {

struct DistanceStatistics {
  int64_t samples = 0;
  double mean = 0, rms = 0, median = 0, p95 = 0, max = 0;  ///< mm
};
DistanceStatistics SummarizeDistances(std::vector<double> distances_mm);

/// Points spread over a mesh by area, about `count`, deterministic by `seed`.
struct SurfaceSamples {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> normals;
};
SurfaceSamples SampleSurface(const TriangleMesh& mesh, int64_t count, uint64_t seed);

/// Unsigned distances from points to the closest point of a mesh, mm.
std::vector<double> DistancesToMesh(const std::vector<Eigen::Vector3d>& points,
                                    const TriangleMesh& mesh);

}  // namespace lfm
