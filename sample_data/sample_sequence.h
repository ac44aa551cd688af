// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "sample_data/random.h"

namespace lfm {

/// The random numbers of one light path: a pure function of (set, index, dimension). The four
/// members (index 0 to 3) of a set are stratified in every dimension: pairs of numbers are the
/// first four points of Sobol's (0, 2) sequence, scrambled at random after Owen 1995, so each has
/// one point a quarter in x, in y, and in each quadrant. Different sets, and different dimensions
/// of one set, are independent; every single number is uniform in [0, 1) on a grid of 2^-24.
struct PathKey {
  uint64_t set = 0;
  uint32_t index = 0;
};

inline constexpr int kSetSize = 4;

/// A set's key from what it belongs to.
inline uint64_t MakeSetKey(uint64_t seed, uint64_t stream, uint64_t item) {
  return ScrambleBits(ScrambleBits(ScrambleBits(seed) ^ stream) ^ item);
}

/// Two stratified numbers; `dimension` counts pairs.
inline std::array<float, 2> RandomPair(const PathKey& key, uint32_t dimension) {
  const uint64_t shared = ScrambleBits(key.set + 0xd1342543de82ef95ull * (dimension + 1));
  const auto flip = [shared](int bit) { return static_cast<uint32_t>(shared >> bit) & 1u; };
  // The order of the four points, then the two leading bits of each coordinate.
  const uint32_t b0 = key.index & 1u, b1 = (key.index >> 1) & 1u;
  const uint32_t i0 = b0 ^ flip(0), i1 = b1 ^ flip(1 + static_cast<int>(b0));
  const uint32_t y0 = i0 ^ i1;
  const uint32_t x = (i0 ^ flip(3)) << 1 | (i1 ^ flip(4 + static_cast<int>(i0)));
  const uint32_t y = (y0 ^ flip(6)) << 1 | (i1 ^ flip(7 + static_cast<int>(y0)));
  const uint64_t own = ScrambleBits(shared ^ (0x9e6c63d0676a9a99ull * (key.index + 1)));
  const uint32_t jitter_x = static_cast<uint32_t>(own >> 42);
  const uint32_t jitter_y = static_cast<uint32_t>(own >> 20) & 0x3fffffu;
  return {static_cast<float>(x << 22 | jitter_x) * 0x1p-24f,
          static_cast<float>(y << 22 | jitter_y) * 0x1p-24f};
}

}  // namespace lfm
