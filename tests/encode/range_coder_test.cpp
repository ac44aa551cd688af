// SPDX-License-Identifier: BSD-3-Clause
#include "encode/range_coder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "encode/coefficient_coder.h"

namespace lfm::testing {
namespace {

TEST(RangeCoder, BitsComeBackInFewerBytesThanTheyAre) {
  for (const double ones : {0.5, 0.1, 0.01, 0.0, 1.0}) {
    std::mt19937 random(3);
    std::bernoulli_distribution bit(ones);
    constexpr int kCount = 40000;
    std::vector<bool> bits;
    for (int i = 0; i < kCount; ++i) bits.push_back(bit(random));
    RangeEncoder encoder;
    BitModel model;
    for (const bool b : bits) encoder.Encode(model, b);
    const std::string bytes = encoder.Finish();
    RangeDecoder decoder(bytes);
    BitModel same;
    for (int i = 0; i < kCount; ++i) ASSERT_EQ(decoder.Decode(same), bits[i]) << i;
    EXPECT_FALSE(decoder.overrun());
    const double entropy =
        ones * (1 - ones) > 0 ? -ones * std::log2(ones) - (1 - ones) * std::log2(1 - ones) : 0;
    EXPECT_LE(static_cast<double>(bytes.size()), 1.06 * entropy * kCount / 8 + 0.003 * kCount)
        << ones;
  }
}

// Long runs of 0xff in what is pending, where a carry goes through all of them.
TEST(RangeCoder, CarriesGoThrough) {
  for (uint32_t seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    RangeEncoder encoder;
    BitModel model;
    std::vector<uint32_t> values;
    std::vector<bool> bits;
    for (int i = 0; i < 100; ++i) {
      values.push_back(random() % 3 == 0 ? 0xffffffffU : static_cast<uint32_t>(random()));
      bits.push_back(random() % 50 != 0);
      encoder.EncodeBits(values.back(), 32);
      encoder.Encode(model, bits.back());
    }
    const std::string bytes = encoder.Finish();
    RangeDecoder decoder(bytes);
    BitModel same;
    for (int i = 0; i < 100; ++i) {
      ASSERT_EQ(decoder.DecodeBits(32), values[i]) << seed;
      ASSERT_EQ(decoder.Decode(same), bits[i]) << seed;
    }
  }
}

TEST(RangeCoder, SaysWhenItReadsBeyondTheEnd) {
  RangeDecoder nothing("");
  EXPECT_TRUE(nothing.overrun());
  RangeEncoder encoder;
  for (int i = 0; i < 100; ++i) encoder.EncodeBits(0x5a5a5a5a, 32);
  const std::string bytes = encoder.Finish();
  RangeDecoder decoder(std::string_view(bytes).substr(0, bytes.size() / 2));
  for (int i = 0; i < 100; ++i) decoder.DecodeBits(32);
  EXPECT_TRUE(decoder.overrun());
}

TEST(NumberModels, NumbersOfEverySizeComeBack) {
  std::vector<uint32_t> values = {0, 1, 2, 3, 1000, (1U << 23) - 2};
  std::mt19937 random(5);
  for (int i = 0; i < 5000; ++i) values.push_back(random() >> (9 + random() % 23));
  RangeEncoder encoder;
  NumberModels models;
  for (const uint32_t value : values) models.Encode(encoder, value);
  const std::string bytes = encoder.Finish();
  RangeDecoder decoder(bytes);
  NumberModels same;
  for (const uint32_t value : values) ASSERT_EQ(same.Decode(decoder), value);
}

CoefficientBlock RandomBlock(std::mt19937& random, int side, int channels, bool triangular) {
  CoefficientBlock block{side, channels, triangular,
                         std::vector<int>(static_cast<size_t>(channels) * side * side, 0)};
  std::normal_distribution<double> normal;
  for (int c = 0; c < channels; ++c) {
    for (int row = 0; row < side; ++row) {
      for (int column = 0; column < (triangular ? row + 1 : side); ++column) {
        block.At(c, row, column) = static_cast<int>(normal(random) * 20 / (1 + row + column));
      }
    }
  }
  return block;
}

TEST(CoefficientModels, BlocksComeBack) {
  std::mt19937 random(7);
  std::vector<CoefficientBlock> blocks;
  for (int i = 0; i < 300; ++i) {
    blocks.push_back(RandomBlock(random, 2 + static_cast<int>(random() % 31), 1 + i % 3, i % 2));
    if (i % 10 == 0) blocks.back().values.assign(blocks.back().values.size(), 0);
    if (i % 17 == 0) blocks.back().At(0, 0, 0) = -(1 << 20);
  }
  RangeEncoder encoder;
  CoefficientModels models;
  for (const CoefficientBlock& block : blocks) models.Encode(encoder, block);
  const std::string bytes = encoder.Finish();
  RangeDecoder decoder(bytes);
  CoefficientModels same;
  for (const CoefficientBlock& block : blocks) {
    CoefficientBlock back{block.side, block.channels, block.triangular,
                          std::vector<int>(block.values.size(), 77)};
    same.Decode(decoder, back);
    ASSERT_EQ(back.values, block.values);
  }
  EXPECT_FALSE(decoder.overrun());
}

TEST(CoefficientModels, SurvivesAnyBytes) {
  std::mt19937 random(9);
  for (int trial = 0; trial < 200; ++trial) {
    std::string bytes(random() % 300, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    RangeDecoder decoder(bytes);
    CoefficientModels models;
    CoefficientBlock block{13, 3, trial % 2 == 0, std::vector<int>(3 * 13 * 13, 0)};
    for (int i = 0; i < 50; ++i) {
      models.Decode(decoder, block);
      for (const int value : block.values) ASSERT_LE(std::abs(value), 1 << 24);
    }
  }
}

}  // namespace
}  // namespace lfm::testing
