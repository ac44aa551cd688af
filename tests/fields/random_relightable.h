// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "fields/relightable_model.h"

namespace lfm {

/// What RandomRelightable makes.
struct RandomRelightableShape {
  int width = 9, height = 5, channels = 3;
  int columns = 20;
  int clusters = 4;  ///< of the sizes 0 to most_terms in turn, columns at most
  int most_terms = 3;
  int most_residuals = 5;  ///< a row has 0 to this many, in columns of their own
  uint32_t seed = 1;
};

/// Directions of a spiral over the sphere; numbers of float16, so that a file keeps them.
RelightableModel RandomRelightable(const RandomRelightableShape& shape);

}  // namespace lfm
