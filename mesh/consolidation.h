// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/point_cloud.h"

namespace lfm {

/// One point for each cube of `voxel_mm` (two where front and back of something thin share it):
/// the confidence-weighted mean of the points in it. Averaging lowers their noise; what lies off
/// the plane through its neighbours by more than five times what is usual, here and over the whole
/// cloud, is dropped. Points must
/// have normals and confidence; no points give none. `voxel_mm` is positive.
PointCloud ConsolidatePoints(const PointCloud& points, double voxel_mm);

}  // namespace lfm
