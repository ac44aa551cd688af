// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "core/ray_scene.h"
#include "resample/light_field.h"
#include "resample/triangle_views.h"
#include "resample/used_photos.h"

namespace lfm {

/// What every triangle is resampled from.
struct ResampleScene {
  const TriangleMesh& mesh;  ///< with normals
  const RayScene& surface;
  const std::vector<Eigen::Matrix3d>& vertex_frames;
  const std::vector<UsedPhoto>& photos;
  const std::vector<PhotoPixels>& seen;               ///< as `photos`
  const std::vector<Eigen::Vector2d>& grid_in_plane;  ///< GridInPlane of the options
  const ResampleOptions& options;
  double max_shift_mm = 0;  ///< for SampleOn::kSurface
};

struct ResampledTriangle {
  LightFieldWriter::Triangle record;
  int64_t samples = 0;       ///< of all views
  int64_t saturated = 0;     ///< of these: a channel is saturated
  int64_t missing = 0;       ///< of these: hidden, or too near a depth edge
  int64_t hidden = 0;        ///< of the missing
  int64_t seen_entries = 0;  ///< of the three corners' view grids
};
/// Samples a triangle's views, imputes what is no data, and weighs the views at its three corners.
/// A view of which too many samples are hidden, or too few are data, is left out
/// (ResampleOptions).
ResampledTriangle ResampleTriangle(const ResampleScene& scene, int triangle,
                                   const TriangleViews& views);
/// Memory that this takes at most, result included, in bytes.
int64_t ResampleTriangleBytes(const ResampleScene& scene, const TriangleViews& views);

}  // namespace lfm
