// SPDX-License-Identifier: BSD-3-Clause
#include "fields/stored_numbers.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "fields/half_floats.h"

namespace lfm {
namespace {

void RoundAll(std::span<float> values) {
  const StoredNumbers stored{HalfExponent(values)};
  for (float& v : values) v = stored.Round(v);
}

}  // namespace

float StoredNumbers::Round(float value) const {
  constexpr uint16_t kLargestHalf = 0x7bff;
  const float largest = HalfValue(kLargestHalf, exponent);
  return HalfValue(HalfBits(std::clamp(value, -largest, largest), exponent), exponent);
}

StoredNumbers StoredNumbersUpTo(float largest) { return {HalfExponent({&largest, 1})}; }

ClusteredModel RoundToStored(ClusteredModel model) {
  for (FunctionRows& basis : model.bases) {
    for (int64_t t = 0; t < basis.rows; ++t) {
      RoundAll({basis.Row(t), static_cast<size_t>(basis.columns)});
    }
  }
  RoundAll(model.weights);
  return model;
}

}  // namespace lfm
