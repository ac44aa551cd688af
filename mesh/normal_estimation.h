// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/point_cloud.h"

namespace lfm {

/// Normals for a cloud that has none (Hoppe et al. 1992): of each point the direction in which its
/// 16 nearest neighbours spread least; then the signs are made to agree from neighbour to neighbour
/// along a minimum spanning tree that prefers like directions. Each piece that hangs together is
/// turned so that its highest point looks up: outside is above. Confidence that is missing becomes
/// 1.
///
/// Points that are not finite get a zero normal and have no say. Fewer than 4 finite points, or all
/// at one place, give zero normals (CleanPoints takes those away). Points in a line get one of the
/// directions across it. Does not depend on the number of threads; time is n log n, memory about
/// 300 bytes a point.
PointCloud EstimateNormals(const PointCloud& points);

}  // namespace lfm
