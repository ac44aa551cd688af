// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/triangle_mesh.h"

namespace lfm {

/// The frames that the MPEG-4 appendix gives vertices which have none of their own (Smirnov,
/// Section 3). With the corners v1, v2, v3 of a triangle, e1 = v1 - v2, e2 = v2 - v3:
///   z = sum over the ring of e1 x e2, normalised    (weighted by area, though called an average)
///   x' = e1 of the first triangle of the ring       (lowest index; not always at the vertex)
///   y = x' x z, x = z x y                           (left-handed)
/// As printed, x and y have the length sin(angle between x' and z) and the frame is undefined where
/// x' is parallel to z: here both are normalised, and the axis least along z serves in place of
/// such an x'. z of a vertex without area is (0, 0, 1). Columns x, y, z; orthonormal, left-handed.
std::vector<Eigen::Matrix3d> AutomaticAfxFrames(const TriangleMesh& mesh);

}  // namespace lfm
