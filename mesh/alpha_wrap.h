// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/point_cloud.h"
#include "core/triangle_mesh.h"

namespace lfm {

struct WrapResult {
  TriangleMesh mesh;    ///< closed, oriented 2-manifold without self-intersections
  double alpha_mm = 0;  ///< the widest opening that the wrap does not enter
};

/// Wraps points from outside (Portaneri et al. 2022, CGAL): a surface that lies `offset_mm` off the
/// points and enters no opening narrower than alpha. Needs no normals.
///
/// A cloud with holes is a shell: entered through a hole, the wrap would line it inside, and hold
/// next to nothing. So alpha begins at a quarter of the extent and is halved, down to three
/// `spacing_mm`, as long as the volume stays above 60 % of the one before: details come out, holes
/// stay closed. Throws Error when there are fewer than four points, or the wrap fails.
WrapResult WrapPoints(const PointCloud& points, double spacing_mm, double offset_mm);

}  // namespace lfm
