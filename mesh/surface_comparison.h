// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/triangle_mesh.h"
#include "mesh/surface_distance.h"

namespace lfm {

/// How near a mesh and a reference lie, by distances from samples of each to the other. With a
/// threshold t (Knapitsch et al. 2017, Tanks and Temples, section 4):
///   accuracy      P = share of the mesh's samples nearer than t to the reference,
///   completeness  R = share of the reference's samples nearer than t to the mesh,
///   f_score       2 P R / (P + R); 0 when both are 0.
struct SurfaceComparison {
  DistanceStatistics from_mesh, from_reference;
  DistanceStatistics both;  ///< all distances together
  double threshold_mm = 0;
  double accuracy = 0, completeness = 0, f_score = 0;  ///< [0, 1]
};

/// From distances that are already there, mm; either list may be empty (share 0). Throws Error when
/// one is negative or not finite, or the threshold is not positive.
SurfaceComparison CompareDistances(std::vector<double> from_mesh,
                                   std::vector<double> from_reference, double threshold_mm);

/// By `samples` points spread over each surface by area, the same ones every time. Throws Error for
/// an invalid mesh or one without area.
SurfaceComparison CompareSurfaces(const TriangleMesh& mesh, const TriangleMesh& reference,
                                  double threshold_mm, int64_t samples = 200000);

/// Throws Error, naming `where`, for a reference that nothing can be compared with: an invalid
/// mesh, one without area, a vertex farther than a kilometre from the origin.
void ValidateReference(const TriangleMesh& reference, const std::string& where);

/// For comparison.json: statistics of each direction and of both, and the shares.
nlohmann::json ComparisonToJson(const SurfaceComparison& comparison);

}  // namespace lfm
