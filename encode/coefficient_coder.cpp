// SPDX-License-Identifier: BSD-3-Clause
// One piece of code writes and reads, so that both take the same decisions in the same order.
#include "encode/coefficient_coder.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

namespace lfm {
namespace {

struct Writing {
  RangeEncoder& coder;
  static constexpr bool kReads = false;
  bool Bit(BitModel& model, bool bit) {
    coder.Encode(model, bit);
    return bit;
  }
  uint32_t Bits(uint32_t value, int count) {
    coder.EncodeBits(value, count);
    return value;
  }
};

struct Reading {
  RangeDecoder& coder;
  static constexpr bool kReads = true;
  bool Bit(BitModel& model, bool) { return coder.Decode(model); }
  uint32_t Bits(uint32_t, int count) { return coder.DecodeBits(count); }
};

// 0, 1, 2, 3-4, 5-7, 8-12, 13-20, more.
int DiagonalClass(int diagonal) {
  constexpr std::array<int, 7> kEnds = {0, 1, 2, 4, 7, 12, 20};
  return static_cast<int>(std::lower_bound(kEnds.begin(), kEnds.end(), diagonal) - kEnds.begin());
}

// Of 2 a + 2 b + c + d + e.
int NeighborClass(int64_t magnitude) {
  constexpr std::array<int64_t, 7> kEnds = {0, 1, 2, 4, 6, 9, 14};
  return static_cast<int>(std::lower_bound(kEnds.begin(), kEnds.end(), magnitude) - kEnds.begin());
}

int64_t Magnitude(const CoefficientBlock& block, int channel, int row, int column) {
  if (row < 0 || column < 0) return 0;
  if (block.triangular && row < column) std::swap(row, column);
  return std::abs(int64_t{block.At(channel, row, column)});
}

int NonzeroDiagonals(const CoefficientBlock& block, int channel) {
  int count = 0;
  for (int row = 0; row < block.side; ++row) {
    for (int column = 0; column < (block.triangular ? row + 1 : block.side); ++column) {
      if (block.At(channel, row, column) != 0) count = std::max(count, row + column + 1);
    }
  }
  return count;
}

}  // namespace

template <typename Coder>
uint32_t NumberModels::Code(Coder& coder, uint32_t value) {
  const uint32_t shifted = value + 1;
  const int wanted = Coder::kReads ? 0 : std::bit_width(shifted) - 1;
  int length = 0;
  while (length < kMostBits - 1 && coder.Bit(length_[length], length < wanted)) ++length;
  uint32_t result = 1, node = 1;
  for (int i = length - 1; i >= 0; --i) {
    const bool bit = (shifted >> i & 1) != 0;
    const bool learnt = length - 1 - i < 3;
    const bool coded = learnt ? coder.Bit(bits_[length][node], bit) : coder.Bits(bit, 1) != 0;
    result = result << 1 | static_cast<uint32_t>(coded);
    if (learnt) node = (node << 1 | static_cast<uint32_t>(coded)) & 7;
  }
  return result - 1;
}

void NumberModels::Encode(RangeEncoder& coder, uint32_t value) {
  Writing writing{coder};
  Code(writing, value);
}

uint32_t NumberModels::Decode(RangeDecoder& coder) {
  Reading reading{coder};
  return Code(reading, 0);
}

CoefficientBlock MakeBlock(int side, int channels, bool triangular) {
  return {side, channels, triangular,
          std::vector<int>(static_cast<size_t>(channels) * side * side, 0)};
}

template <typename Coder, typename Block>
void CoefficientModels::CodeValue(Coder& coder, int channel, int row, int column, Block& block) {
  const int64_t near = 2 * Magnitude(block, channel, row - 1, column) +
                       2 * Magnitude(block, channel, row, column - 1) +
                       Magnitude(block, channel, row - 1, column - 1) +
                       Magnitude(block, channel, row - 2, column) +
                       Magnitude(block, channel, row, column - 2);
  const int neighbors = NeighborClass(near);
  const int first = channel == 0 ? 0 : std::min(std::abs(block.At(0, row, column)), 2);
  auto&& value = block.At(channel, row, column);
  const int magnitude = std::abs(value);
  BitModel& nonzero =
      nonzero_[channel == 0 ? 0 : 1 + first][DiagonalClass(row + column)][neighbors];
  int coded = coder.Bit(nonzero, magnitude != 0) ? 1 : 0;
  if (coded != 0 && coder.Bit(above_one_[channel == 0 ? 0 : 1][neighbors], magnitude > 1)) {
    NumberModels& rest = rest_[neighbors];
    coded = 2 + static_cast<int>(rest.Code(coder, static_cast<uint32_t>(magnitude - 2)));
  }
  const bool negative = coded != 0 && coder.Bits(value < 0 ? 1 : 0, 1) != 0;
  if constexpr (Coder::kReads) value = negative ? -coded : coded;
}

template <typename Coder, typename Block>
void CoefficientModels::Code(Coder& coder, Block& block) {
  const int most = 2 * block.side - 1;
  for (int channel = 0; channel < block.channels; ++channel) {
    const int wanted = Coder::kReads ? 0 : NonzeroDiagonals(block, channel);
    NumberModels& numbers = diagonals_[std::min(channel, 2)];
    const int diagonals =
        std::min(most, static_cast<int>(numbers.Code(coder, static_cast<uint32_t>(wanted))));
    if constexpr (Coder::kReads) block.diagonals[channel] = diagonals;
    for (int d = 0; d < diagonals; ++d) {
      const int first = std::max(0, d - block.side + 1), last = std::min(d, block.side - 1);
      for (int row = block.triangular ? (d + 1) / 2 : first; row <= last; ++row) {
        CodeValue(coder, channel, row, d - row, block);
      }
    }
  }
}

void CoefficientModels::Encode(RangeEncoder& coder, const CoefficientBlock& block) {
  Writing writing{coder};
  Code(writing, block);
}

void CoefficientModels::Decode(RangeDecoder& coder, CoefficientBlock& block) {
  std::fill(block.values.begin(), block.values.end(), 0);
  Reading reading{coder};
  Code(reading, block);
}

}  // namespace lfm
