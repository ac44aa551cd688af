// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace lfm {

/// Scrambles 64 bits (the finaliser of SplitMix64; Steele, Lea and Flood 2014).
inline uint64_t ScrambleBits(uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// A stream of random numbers that is a pure function of its key, so that every pixel or vertex
/// can have its own and results do not depend on the order of work.
class RandomStream {
 public:
  RandomStream(uint64_t seed, uint64_t stream, uint64_t item)
      : state_(ScrambleBits(ScrambleBits(ScrambleBits(seed) ^ stream) ^ item)) {}

  uint64_t Bits() { return ScrambleBits(state_ += 0x9e3779b97f4a7c15ull); }
  /// Uniform in [0, 1).
  double Uniform() { return static_cast<double>(Bits() >> 11) * 0x1p-53; }
  /// Uniform in [low, high).
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }
  /// Standard normal (Box and Muller 1958; the second value of a pair is kept).
  double Normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    const double radius = std::sqrt(-2 * std::log(1 - Uniform()));
    const double angle = 2 * std::numbers::pi * Uniform();
    spare_ = radius * std::sin(angle);
    has_spare_ = true;
    return radius * std::cos(angle);
  }

 private:
  uint64_t state_;
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace lfm
