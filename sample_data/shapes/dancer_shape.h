// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "sample_data/shapes/shape.h"

namespace lfm {

/// A ballet dancer on a round foot, 120 mm high: on the tip of one foot, the other leg raised
/// behind, one arm over the head, one to the side, in a tutu as thin as a cloth. Stands on z = 0
/// round the origin and faces -y; limbs are 2 to 6 mm thick. With paint of its own: skin, hair,
/// dress, shoes, foot. Closed for edges up to 1.4 mm; throws Error where they do not resolve it.
Shape MakeDancer(double edge_mm, uint64_t seed);

}  // namespace lfm
