// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fields/clustered_model.h"

namespace lfm {

/// Float16 numbers times one power of two for all of them (fields/half_floats.h), which takes any
/// magnitude of float32 into float16's range: what a model's numbers become in a file.
struct StoredNumbers {
  int exponent = 0;  ///< stored * 2^exponent is the number

  /// The nearest such number, ties to even; beyond the largest, the largest of that sign.
  float Round(float value) const;
};

/// The power of two for numbers up to this magnitude, which leaves a bit for larger ones.
StoredNumbers StoredNumbersUpTo(float largest);

/// The model with its bases and weights as they will be stored: a power of two for each basis
/// function, and one for all weights. What was rounded so before comes back unchanged where it is
/// at least 2^-28 of the largest.
ClusteredModel RoundToStored(ClusteredModel model);

}  // namespace lfm
