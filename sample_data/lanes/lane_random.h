// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sample_data/lanes/lane_math.h"

namespace lfm {
inline namespace LFM_LANE_SET {

/// ScrambleBits of sample_data/random.h.
template <typename U>
LFM_LANE U ScrambleLanes(U x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// RandomPair of sample_data/sample_sequence.h, which says what it is.
template <typename F>
struct NumberPair {
  F first, second;
};
template <typename F>
LFM_LANE NumberPair<F> RandomLanes(ULongOf<F> set, UIntOf<F> index, uint32_t dimension) {
  using U = UIntOf<F>;
  const ULongOf<F> shared = ScrambleLanes(set + 0xd1342543de82ef95ull * (uint64_t{dimension} + 1));
  const U bits = LowBits(shared);
  const auto flip = [&](auto bit) -> U { return (bits >> bit) & 1u; };
  // The order of the four points, then the two leading bits of each coordinate.
  const U b0 = index & 1u, b1 = (index >> 1) & 1u;
  const U i0 = b0 ^ flip(0u), i1 = b1 ^ flip(1u + b0);
  const U y0 = i0 ^ i1;
  const U x = (i0 ^ flip(3u)) << 1 | (i1 ^ flip(4u + i0));
  const U y = (y0 ^ flip(6u)) << 1 | (i1 ^ flip(7u + y0));
  // One, two, three or four times the constant, without a product.
  constexpr uint64_t kOwn = 0x9e6c63d0676a9a99ull;
  const ULongOf<F> times = kOwn + (kOwn & -Widen(b0)) + (2 * kOwn & -Widen(b1));
  const ULongOf<F> own = ScrambleLanes(shared ^ times);
  const U jitter_x = LowBits(own >> 42), jitter_y = LowBits(own >> 20) & 0x3fffffu;
  return {ToFloat(AsInt(x << 22 | jitter_x)) * 0x1p-24f,
          ToFloat(AsInt(y << 22 | jitter_y)) * 0x1p-24f};
}

}  // namespace LFM_LANE_SET
}  // namespace lfm
