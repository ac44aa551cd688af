// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "encode/range_coder.h"

namespace lfm {

/// Learnt probabilities of an unsigned number: Elias gamma code of value + 1, its length unary, the
/// bits after the leading one learnt down to three.
class NumberModels {
 public:
  void Encode(RangeEncoder& coder, uint32_t value);
  uint32_t Decode(RangeDecoder& coder);

 private:
  friend class CoefficientModels;
  static constexpr int kMostBits = 24;
  template <typename Coder>
  uint32_t Code(Coder& coder, uint32_t value);
  std::array<BitModel, kMostBits> length_;
  std::array<std::array<BitModel, 8>, kMostBits> bits_;
};

/// Quantised coefficients of a transformed map: `channels` planes of side x side, row-major.
/// `triangular`: only row >= column is coded, and the rest read as its mirror image.
struct CoefficientBlock {
  int side = 0, channels = 1;
  bool triangular = false;
  std::vector<int> values;
  /// Of each channel, how many diagonals hold anything; Decode sets it.
  std::array<int, 3> diagonals{};

  int& At(int channel, int row, int column) {
    return values[(channel * side + row) * side + column];
  }
  int At(int channel, int row, int column) const {
    return values[(channel * side + row) * side + column];
  }
};

/// All zero.
CoefficientBlock MakeBlock(int side, int channels, bool triangular);

/// Codes blocks of one kind one after the other: for each channel how many diagonals (row + column)
/// hold anything, then their coefficients, low frequencies first. Probabilities depend on the
/// magnitudes of five neighbours of lower frequency, on the diagonal, and on the first channel's
/// coefficient at the same place.
///
/// Magnitudes are at most 2^24 + 1. Decoding damaged bytes gives wrong coefficients in those
/// bounds.
class CoefficientModels {
 public:
  void Encode(RangeEncoder& coder, const CoefficientBlock& block);
  /// `block` comes with its sizes; values are overwritten.
  void Decode(RangeDecoder& coder, CoefficientBlock& block);

 private:
  static constexpr int kChannelClasses = 4, kDiagonalClasses = 8, kNeighborClasses = 8;
  template <typename Coder, typename Block>
  void Code(Coder& coder, Block& block);
  // Returns the magnitude; `near` points to its place among those of the channel.
  template <typename Coder, typename Block>
  int CodeValue(Coder& coder, int channel, int row, int column, int diagonal_class, const int* near,
                Block& block);

  std::array<NumberModels, 3> diagonals_;
  std::array<std::array<std::array<BitModel, kNeighborClasses>, kDiagonalClasses>, kChannelClasses>
      nonzero_;
  std::array<std::array<BitModel, kNeighborClasses>, 2> above_one_;
  std::array<NumberModels, kNeighborClasses> rest_;
  // Of the channel being coded, both halves of triangles, behind a border of zeros: the
  // neighbours of lower frequency lie at fixed distances.
  static constexpr int kBorder = 2;
  std::vector<int> magnitudes_;
};

}  // namespace lfm
