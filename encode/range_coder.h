// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace lfm {

/// The probability of a 0 bit, learnt from the bits that were coded with it: the mean of a fast and
/// a slow estimate. The first bits count for more, as if there had been half a bit before them.
class BitModel {
 public:
  /// Of 32768; never 0 nor 32768.
  uint32_t zero() const {
    const uint32_t p = (uint32_t{fast_} + slow_) >> 2;
    return p < kLeast ? kLeast : p > 32768 - kLeast ? 32768 - kLeast : p;
  }
  void Learn(bool bit) {
    const int target = bit ? 0 : 65535, from_fast = target - fast_, from_slow = target - slow_;
    if (count_ < kSlow) {
      const int share = kShares[count_++];
      fast_ = static_cast<uint16_t>(fast_ + ((from_fast * (share > kFast ? share : kFast)) >> 15));
      slow_ = static_cast<uint16_t>(slow_ + ((from_slow * share) >> 15));
      return;
    }
    fast_ = static_cast<uint16_t>(fast_ + (from_fast >> 4));
    slow_ = static_cast<uint16_t>(slow_ + (from_slow >> 7));
  }

 private:
  static constexpr uint32_t kLeast = 32;
  static constexpr int kSlow = 128, kFast = 32768 / 16;
  // 1 / (n + 1/2) of 32768, for the n-th bit.
  static constexpr std::array<uint16_t, kSlow> kShares = [] {
    std::array<uint16_t, kSlow> shares{};
    for (int n = 1; n <= kSlow; ++n) shares[n - 1] = static_cast<uint16_t>(65536 / (2 * n + 1));
    return shares;
  }();
  uint16_t fast_ = 32768, slow_ = 32768, count_ = 0;
};

/// Binary range coder with carry propagation (Martin 1979; bits with learnt probabilities as in
/// LZMA).
class RangeEncoder {
 public:
  void Encode(BitModel& model, bool bit);
  /// The lowest `count` (0 to 32) bits, all equally likely.
  void EncodeBits(uint32_t value, int count);
  /// Everything that was encoded; the encoder must not be used afterwards.
  std::string Finish();

 private:
  void Shift();
  uint64_t low_ = 0;
  uint32_t range_ = 0xffffffff;
  uint8_t cache_ = 0;
  int64_t pending_ = 1;  // bytes that a carry may still change
  std::string bytes_;
};

/// Reads what RangeEncoder wrote. Reads zeros beyond the end and says so: damaged input gives wrong
/// bits and never an endless loop or an access out of bounds. `bytes` must outlive the decoder.
class RangeDecoder {
 public:
  explicit RangeDecoder(std::string_view bytes);
  bool Decode(BitModel& model) {
    const uint32_t bound = (range_ >> 15) * model.zero();
    const bool bit = code_ >= bound;
    if (bit) {
      code_ -= bound;
      range_ -= bound;
    } else {
      range_ = bound;
    }
    model.Learn(bit);
    if (range_ < kLeastRange) Normalize();
    return bit;
  }
  uint32_t DecodeBits(int count);
  bool overrun() const { return overrun_; }

 private:
  static constexpr uint32_t kLeastRange = 1U << 24;
  uint8_t NextByte();
  void Normalize();
  std::string_view bytes_;
  size_t next_ = 0;
  bool overrun_ = false;
  uint32_t range_ = 0xffffffff, code_ = 0;
};

}  // namespace lfm
