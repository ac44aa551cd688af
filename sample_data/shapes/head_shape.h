// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sample_data/shapes/shape.h"

namespace lfm {

enum class HeadPart { kSkin, kHair };

/// A head on its neck, 100 mm high, round the origin (the middle of the skull), looking to -y: the
/// bust's (sample_data/bust_shape.h), 1.7 times as large. Closed for edges up to 3 mm.
Shape MakeHead(HeadPart part, double edge_mm);

}  // namespace lfm
