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

// Of 2 a + 2 b + c + d + e: 0, 1, 2, 3-4, 5-6, 7-9, 10-14, more.
int NeighborClass(int magnitude) {
  constexpr std::array<uint8_t, 16> kClasses = {0, 1, 2, 3, 3, 4, 4, 5, 5, 5, 6, 6, 6, 6, 6, 7};
  return kClasses[std::min(magnitude, 15)];
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
int CoefficientModels::CodeValue(Coder& coder, int channel, int row, int column, int diagonal_class,
                                 const int* near, Block& block) {
  const int stride = block.side + kBorder;
  const int neighbors = NeighborClass(2 * (near[-stride] + near[-1]) + near[-stride - 1] +
                                      near[-2 * stride] + near[-2]);
  const int first = channel == 0 ? 0 : std::min(std::abs(block.At(0, row, column)), 2);
  auto&& value = block.At(channel, row, column);
  const int magnitude = std::abs(value);
  BitModel& nonzero = nonzero_[channel == 0 ? 0 : 1 + first][diagonal_class][neighbors];
  int coded = coder.Bit(nonzero, magnitude != 0) ? 1 : 0;
  if (coded == 0) return 0;
  if (coder.Bit(above_one_[channel == 0 ? 0 : 1][neighbors], magnitude > 1)) {
    NumberModels& rest = rest_[neighbors];
    coded = 2 + static_cast<int>(rest.Code(coder, static_cast<uint32_t>(magnitude - 2)));
  }
  const bool negative = coder.Bits(value < 0 ? 1 : 0, 1) != 0;
  if constexpr (Coder::kReads) value = negative ? -coded : coded;
  return coded;
}

template <typename Coder, typename Block>
void CoefficientModels::Code(Coder& coder, Block& block) {
  const int most = 2 * block.side - 1, stride = block.side + kBorder;
  for (int channel = 0; channel < block.channels; ++channel) {
    const int wanted = Coder::kReads ? 0 : NonzeroDiagonals(block, channel);
    NumberModels& numbers = diagonals_[std::min(channel, 2)];
    const int diagonals =
        std::min(most, static_cast<int>(numbers.Code(coder, static_cast<uint32_t>(wanted))));
    if constexpr (Coder::kReads) block.diagonals[channel] = diagonals;
    const int rows = std::min(diagonals, block.side) + kBorder;
    magnitudes_.assign(static_cast<size_t>(rows) * stride, 0);
    for (int d = 0; d < diagonals; ++d) {
      const int first = std::max(0, d - block.side + 1), last = std::min(d, block.side - 1);
      const int diagonal_class = DiagonalClass(d);
      for (int row = block.triangular ? (d + 1) / 2 : first; row <= last; ++row) {
        const int column = d - row;
        int* near = magnitudes_.data() + (row + kBorder) * stride + column + kBorder;
        *near = CodeValue(coder, channel, row, column, diagonal_class, near, block);
        if (!block.triangular) continue;
        magnitudes_[(column + kBorder) * stride + row + kBorder] = *near;
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
