// SPDX-License-Identifier: BSD-3-Clause
#include "encode/range_coder.h"

namespace lfm {
namespace {

constexpr uint32_t kLeastRange = 1U << 24;

}  // namespace

void RangeEncoder::Shift() {
  if (low_ < 0xff000000U || low_ > 0xffffffffU) {
    const auto carry = static_cast<uint8_t>(low_ >> 32);
    while (pending_ > 0) {
      bytes_.push_back(static_cast<char>(cache_ + carry));
      cache_ = 0xff;
      --pending_;
    }
    cache_ = static_cast<uint8_t>(low_ >> 24);
  }
  ++pending_;
  low_ = (low_ & 0x00ffffffU) << 8;
}

void RangeEncoder::Encode(BitModel& model, bool bit) {
  const uint32_t bound = (range_ >> 15) * model.zero();
  if (bit) {
    low_ += bound;
    range_ -= bound;
  } else {
    range_ = bound;
  }
  model.Learn(bit);
  while (range_ < kLeastRange) {
    range_ <<= 8;
    Shift();
  }
}

void RangeEncoder::EncodeBits(uint32_t value, int count) {
  for (int i = count - 1; i >= 0; --i) {
    range_ >>= 1;
    if (value >> i & 1) low_ += range_;
    while (range_ < kLeastRange) {
      range_ <<= 8;
      Shift();
    }
  }
}

std::string RangeEncoder::Finish() {
  for (int i = 0; i < 5; ++i) Shift();
  return std::move(bytes_);
}

RangeDecoder::RangeDecoder(std::string_view bytes) : bytes_(bytes) {
  for (int i = 0; i < 5; ++i) code_ = code_ << 8 | NextByte();
}

uint8_t RangeDecoder::NextByte() {
  if (next_ < bytes_.size()) return static_cast<uint8_t>(bytes_[next_++]);
  overrun_ = true;
  return 0;
}

void RangeDecoder::Normalize() {
  while (range_ < kLeastRange) {
    range_ <<= 8;
    code_ = code_ << 8 | NextByte();
  }
}

uint32_t RangeDecoder::DecodeBits(int count) {
  uint32_t value = 0;
  for (int i = 0; i < count; ++i) {
    range_ >>= 1;
    const bool bit = code_ >= range_;
    if (bit) code_ -= range_;
    value = value << 1 | static_cast<uint32_t>(bit);
    Normalize();
  }
  return value;
}

}  // namespace lfm
