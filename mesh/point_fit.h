// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/point_cloud.h"
#include "core/triangle_mesh.h"

namespace lfm {

/// Brings back what an implicit surface smoothed away: ridges that it lowered, grooves that it
/// filled. Each vertex moves along its normal by the mean residual of the points round it, that is
/// their signed distances from the *surface* (not from a plane: a curved surface that fits its
/// points stays), weighted by the root of their confidence and a Gaussian of `sigma_mm`. Done five
/// times, as residual correction.
///
/// `points` need normals and confidence. Points farther than two sigma from the surface, or that
/// look another way than the triangle beneath them (more than 72 degrees), do not count; vertices
/// without points near them, and those within the cap at z <= 0, stay; where a wall ends on the
/// platform they move sideways only. No triangle turns by more than 45 degrees in a pass. A cloud
/// without points changes nothing.
TriangleMesh FitToPoints(const TriangleMesh& mesh, const PointCloud& points, double sigma_mm);

}  // namespace lfm
