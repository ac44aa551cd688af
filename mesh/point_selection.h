// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/point_cloud.h"

namespace lfm {

/// Those points of a cloud with normals and confidence whose entry in `keep` (one a point) is not
/// 0, in order.
PointCloud SelectPoints(const PointCloud& cloud, const std::vector<char>& keep);

}  // namespace lfm
