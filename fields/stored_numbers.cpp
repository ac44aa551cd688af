// SPDX-License-Identifier: BSD-3-Clause
#include "fields/stored_numbers.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace lfm {
namespace {

constexpr float kLargestHalf = 65504;
constexpr double kPlainFrom = 0x1p-6, kPlainTo = 0x1p15;

float LargestMagnitude(const std::vector<float>& values) {
  float largest = 0;
  for (float v : values) largest = std::max(largest, std::abs(v));
  return largest;
}

void RoundAll(std::vector<float>& values, const StoredNumbers& stored) {
  for (float& v : values) v = stored.Round(v);
}

}  // namespace

float StoredNumbers::Round(float value) const {
  const float scaled = exponent == 0 ? value : std::ldexp(value, -exponent);
  const auto half =
      static_cast<float>(Eigen::half(std::clamp(scaled, -kLargestHalf, kLargestHalf)));
  return exponent == 0 ? half : std::ldexp(half, exponent);
}

StoredNumbers StoredNumbersUpTo(double largest) {
  if (!(largest > 0) || (largest >= kPlainFrom && largest <= kPlainTo)) return {};
  return {std::ilogb(largest)};
}

ClusteredModel RoundToStored(ClusteredModel model) {
  float largest = 0;
  for (const FunctionRows& basis : model.bases) {
    largest = std::max(largest, LargestMagnitude(basis.values));
  }
  const StoredNumbers of_bases = StoredNumbersUpTo(largest);
  for (FunctionRows& basis : model.bases) RoundAll(basis.values, of_bases);
  RoundAll(model.weights, StoredNumbersUpTo(LargestMagnitude(model.weights)));
  return model;
}

}  // namespace lfm
