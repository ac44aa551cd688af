// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "sample_data/shapes/shape.h"

namespace lfm {

enum class HelmetPart { kSteel, kBrass };

/// A visored bascinet, 105 mm high, that stands on z = 0 and looks to -y: a pointed skull with a
/// ridge, a snouted visor with eye slit and breathing holes, a flared neck. A hollow shell 2.4 mm
/// strong, closed for edges up to 1.6 mm. The brass part is its trim: a band round the neck,
/// rivets, the visor's hinges and a finial (edges up to 1.2 mm).
Shape MakeHelmet(HelmetPart part, double edge_mm);

}  // namespace lfm
