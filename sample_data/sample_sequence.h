// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "sample_data/lanes/lane_random.h"
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
  const NumberPair<float> pair = RandomLanes<float>(key.set, key.index, dimension);
  return {pair.first, pair.second};
}

}  // namespace lfm
