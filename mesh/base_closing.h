// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/point_cloud.h"

namespace lfm {

/// Points that continue the object below what was measured, so that its surface can be closed flat
/// on the platform (z = 0). The object stands there and nobody has seen its base: the walls of the
/// lowest measured ring are continued along their slope (at most 45 degrees, and at most four
/// spacings sideways) to six spacings below the platform, and a floor is laid there.
///
/// What is floor follows from the walls by the winding number in the plane, for points x_i with
/// outward unit normals n_i that stand for a length l_i of contour each:
///   w(x) = 1 / (2 pi) sum_i l_i n_i . (x_i - x) / |x_i - x|^2,   floor where w > 1/2.
/// So holes stay holes, several feet stay apart, and gaps in a ring are bridged.
///
/// Confidence is 0. Returns no points when the object does not reach down: when its measured
/// surface is closed below, or the lowest ring is not found.
PointCloud ContinueBelowPlatform(const PointCloud& object, double spacing_mm);

}  // namespace lfm
