// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>

#include "core/triangle_mesh.h"
#include "resample/direction_map.h"
#include "resample/light_field.h"

namespace lfm {

/// What the factorisation reads of a resampled light field: a LightField file, or data in memory.
///
/// `patch` and `weights` are called from many threads at once. The references live as long as the
/// source.
struct LightFieldSource {
  const TriangleMesh& mesh;                           ///< mm, world frame
  const std::vector<Eigen::Matrix3d>& vertex_frames;  ///< one a vertex
  DirectionMap direction_map = DirectionMap::kHemiOctahedral;
  int grid = 32;  ///< directions a side
  std::function<TrianglePatch(int triangle)> patch;
  std::function<ViewWeights(int triangle, int corner, LightField::WeightBuffer& buffer)> weights;
  int64_t dense_bytes = 0;  ///< 3 x samples x grid^2, over all triangles
};

/// The source behind an open file; `light_field` must outlive it.
LightFieldSource SourceFromLightField(const LightField& light_field);

/// Throws Error when the counts, sizes or indices of one triangle do not fit together, so that no
/// later step reads out of bounds.
void CheckSourceTriangle(const LightFieldSource& source, int triangle);

}  // namespace lfm
