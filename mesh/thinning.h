// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "core/point_cloud.h"

namespace lfm {

/// A cloud of more than `most` points brought down to about that many by averaging in cubes, in one
/// pass: beyond the cloud itself, memory grows with what is left only (about 100 bytes a point).
/// Smaller clouds come back as they are. One point for each cube (two where points face opposite
/// ways), the mean weighted by confidence, in order of first appearance; normals are unit or zero,
/// confidence is the mean (missing: 1). The cubes' size follows from the surface's area, as a
/// hundred thousand of the points show it.
///
/// Throws Error, naming `where`, when normals or confidence are miscounted, or a point is not
/// finite. `most` is positive.
PointCloud ThinPoints(const PointCloud& points, int64_t most,
                      const std::string& where = "point cloud");

}  // namespace lfm
