// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "resample/photo_gains.h"
#include "resample/triangle_resampling.h"

namespace lfm {

/// Mean colours of up to 1000 triangles in the photographs that show them, from a few
/// samples each, in parallel. They are spread evenly over those that six photographs see; a view
/// with a saturated sample, or one near a depth edge, is left out.
std::vector<TriangleShades> MeasureShades(const ResampleScene& scene, const VisibleLists& lists);

}  // namespace lfm
