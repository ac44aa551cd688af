// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace lfm {

/// The starts of iterations: splitmix64 (Steele, Lea, Flood 2014), since the standard library's
/// distributions differ between libraries. The same sequence every time.
class PseudoRandom {
 public:
  /// Uniform in [-1, 1), a multiple of 2^-23.
  double Next() {
    state_ += 0x9e3779b97f4a7c15;
    uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    z ^= z >> 31;
    return static_cast<double>(z >> 40) / (1 << 23) - 1;
  }

 private:
  uint64_t state_ = 0x6c66'6d20'7063'6121;
};

}  // namespace lfm
