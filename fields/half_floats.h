// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lfm {

/// Numbers as float16 with a power of two in common: value = half * 2^exponent. The largest
/// magnitude is brought to [2^14, 2^15), so what is 2^-28 of it still has all of float16's 11 bits,
/// whatever the scale of the whole, and numbers that float16 holds are kept exactly as long as they
/// lie within 2^28 of the largest.
struct HalfFloats {
  int exponent = 0;  ///< 0 for no numbers, or zeros alone
  std::vector<uint16_t> bits;
};

/// Every exponent of a float32's scale, and the only ones that the functions below take.
constexpr int kLeastHalfExponent = -170, kLargestHalfExponent = 120;

/// The exponent for these numbers, which must be finite.
int HalfExponent(std::span<const float> values);
/// The nearest float16 of value / 2^exponent, to even.
uint16_t HalfBits(float value, int exponent);
/// half * 2^exponent; NaN and infinities pass.
float HalfValue(uint16_t bits, int exponent);
HalfFloats ToHalf(std::span<const float> values);

}  // namespace lfm
