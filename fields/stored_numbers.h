// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fields/clustered_model.h"

namespace lfm {

/// Float16 numbers times one power of two for all of them, which takes any magnitude of float32
/// into float16's range: what a model's numbers become in a file.
struct StoredNumbers {
  int exponent = 0;  ///< stored * 2^exponent is the number

  /// The nearest such number, ties to even; beyond the largest, the largest of that sign.
  float Round(float value) const;
};

/// The power of two for numbers up to this magnitude: 0 (plain float16) from 2^-6 to 2^15,
/// elsewhere the one that brings `largest` into [1, 2); 0 for none.
StoredNumbers StoredNumbersUpTo(double largest);

/// The model with its bases and weights as they will be stored, each kind with a power of two of
/// its own. What was rounded so before comes back unchanged.
ClusteredModel RoundToStored(ClusteredModel model);

}  // namespace lfm
