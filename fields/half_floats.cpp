// SPDX-License-Identifier: BSD-3-Clause
#include "fields/half_floats.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace lfm {

namespace {

// Exact in float64 for every exponent that a float's scale can have.
double PowerOfTwo(int exponent) {
  return Eigen::numext::bit_cast<double>(static_cast<uint64_t>(1023 + exponent) << 52);
}

}  // namespace

int HalfExponent(std::span<const float> values) {
  float largest = 0;
  for (const float v : values) largest = std::max(largest, std::abs(v));
  return largest == 0 ? 0 : std::ilogb(largest) - 14;
}

uint16_t HalfBits(float value, int exponent) {
  return Eigen::numext::bit_cast<uint16_t>(
      Eigen::half(static_cast<float>(value * PowerOfTwo(-exponent))));
}

float HalfValue(uint16_t bits, int exponent) {
  const auto half = Eigen::numext::bit_cast<Eigen::half>(bits);
  return static_cast<float>(double{static_cast<float>(half)} * PowerOfTwo(exponent));
}

HalfFloats ToHalf(std::span<const float> values) {
  HalfFloats result;
  result.exponent = HalfExponent(values);
  result.bits.reserve(values.size());
  for (const float v : values) result.bits.push_back(HalfBits(v, result.exponent));
  return result;
}

}  // namespace lfm
