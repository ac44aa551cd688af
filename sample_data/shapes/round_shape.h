// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "sample_data/shapes/shape.h"

namespace lfm {

/// An ellipsoid round the origin with semi-axes `radii` (mm): a cube's faces blown up with equal
/// angles, edges of about `edge_mm` along the longest semi-axis. Exact normals; closed.
Shape MakeEllipsoid(const Eigen::Vector3d& radii, double edge_mm);

/// The upper half of a ball round the origin, closed by a flat base in z = 0. On the dome, and on
/// its rim, normals are exactly the ball's; the base takes its own within 2 % of the rim.
Shape MakeHemisphere(double radius, double edge_mm);

/// A bowl that opens upwards: the inside is the lower half of a ball of `radius` round the origin,
/// with its exact normals (towards the origin); the wall is `thickness` strong, its lip flat.
Shape MakeBowl(double radius, double thickness, double edge_mm);

}  // namespace lfm
