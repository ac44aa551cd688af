// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/point_cloud.h"
#include "core/triangle_mesh.h"
#include "mesh/free_space.h"

namespace lfm {

/// Points at which a solid that was closed without data has to end, because scans saw through what
/// lies beyond: the border between the free and the other part of the solid's inside.
///
/// The inside of `solid` (closed, counter-clockwise from outside) is looked at in cubes of
/// `cell_mm`; where a free cube meets one that is not free, a point is set between them, with the
/// mean direction towards the free cubes round it as normal. Points nearer than `clearance_mm` to
/// one of `measured`, or lower than that above the platform, are left out: there the data speak. A
/// place is only ever claimed free, never solid: what the points close off may still be too much.
///
/// Confidence is 0. No free space, or none in the solid, gives no points.
PointCloud FindCarvedBorder(const TriangleMesh& solid, const FreeSpace& free,
                            const PointCloud& measured, double cell_mm, double clearance_mm);

}  // namespace lfm
