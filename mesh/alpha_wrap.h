// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/point_cloud.h"
#include "core/triangle_mesh.h"
#include "mesh/free_space.h"

namespace lfm {

struct WrapResult {
  TriangleMesh mesh;        ///< closed, oriented 2-manifold without self-intersections
  double alpha_mm = 0;      ///< radius of the widest opening that the wrap does not enter
  int64_t wall_points = 0;  ///< that close holes in the data; see below
};

/// Wraps points from outside (Portaneri et al. 2022, CGAL): a surface that lies `offset_mm` off the
/// points and enters no opening narrower than twice alpha. Needs no normals.
///
/// Alpha begins at the extent, where nothing is entered, and is halved down to three `spacing_mm`:
/// details come out. A cloud with holes is a shell, though: entered through a hole the wrap lines
/// it inside too, and holds next to nothing. So where halving alpha leaves the wrap thinner than
/// alpha / 4 (or three offsets) under a tenth more of the points than before, the wrap before is
/// kept as a wall: its places that lie farther than half the new alpha from all data become points
/// to wrap. The gap that they leave along the hole's rim is too narrow to enter, and narrows as
/// alpha does. What `free` says to be empty gets no wall, for there an opening was seen through,
/// but one where the free space inside the wrap ends (FindCarvedBorder). A thin bowl that nobody
/// looked into cannot be told from a ball with a hole, and is closed. Where the wrap falls through
/// in spite of the wall, between points too far apart for the new alpha, the wrap before is the
/// result.
///
/// Throws Error when there are fewer than four points, or the wrap fails.
WrapResult WrapPoints(const PointCloud& points, double spacing_mm, double offset_mm,
                      const FreeSpace& free);

}  // namespace lfm
