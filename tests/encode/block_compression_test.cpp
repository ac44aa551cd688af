// SPDX-License-Identifier: BSD-3-Clause
// The decoder is compared with OpenGL's in tests/viewer/gl_block_textures_test.cpp.
#include "encode/block_compression.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/error.h"

namespace lfm::testing {
namespace {

using Rgb = std::array<uint8_t, 3>;
constexpr BlockQuality kQualities[] = {BlockQuality::kFast, BlockQuality::kGood,
                                       BlockQuality::kBest};

TexelWeights AllAlike() {
  TexelWeights weights;
  weights.fill(1);
  return weights;
}

double Error1(const std::array<uint8_t, 16>& a, const std::array<uint8_t, 16>& b,
              const TexelWeights& weights) {
  double sum = 0;
  for (int i = 0; i < 16; ++i) sum += double{weights[i]} * (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

double Error3(const std::array<Rgb, 16>& a, const std::array<Rgb, 16>& b,
              const std::array<float, 3>& channels = {1, 1, 1}) {
  double sum = 0;
  for (int i = 0; i < 16; ++i) {
    for (int c = 0; c < 3; ++c) {
      sum += double{channels[c]} * (a[i][c] - b[i][c]) * (a[i][c] - b[i][c]);
    }
  }
  return sum;
}

// The specifications' real-number formulas: what any decoder's values lie near.
TEST(BlockCompression, DecodersStayNearTheSpecifications) {
  std::mt19937 random(1);
  double bc1_most = 0, bc4_most = 0;
  for (int round = 0; round < 2000; ++round) {
    Block block;
    for (uint8_t& byte : block) byte = static_cast<uint8_t>(random());
    const int c0 = block[0] | block[1] << 8, c1 = block[2] | block[3] << 8;
    const auto texels = DecodeBc1(block);
    for (int i = 0; i < 16; ++i) {
      const int index = block[4 + i / 4] >> 2 * (i % 4) & 3;
      for (int c = 0; c < 3; ++c) {
        constexpr int kShift[] = {11, 5, 0}, kMost[] = {31, 63, 31};
        const double a = 255.0 * (c0 >> kShift[c] & kMost[c]) / kMost[c];
        const double b = 255.0 * (c1 >> kShift[c] & kMost[c]) / kMost[c];
        const double value = index == 0   ? a
                             : index == 1 ? b
                             : c0 > c1    ? (index == 2 ? (2 * a + b) / 3 : (a + 2 * b) / 3)
                             : index == 2 ? (a + b) / 2
                                          : 0;
        bc1_most = std::max(bc1_most, std::abs(value - texels[i][c]));
      }
    }
    const auto reds = DecodeBc4(block);
    uint64_t bits = 0;
    for (int i = 0; i < 6; ++i) bits |= uint64_t{block[2 + i]} << 8 * i;
    for (int i = 0; i < 16; ++i) {
      const int k = static_cast<int>(bits >> 3 * i & 7);
      const double a = block[0], b = block[1];
      const double value = k == 0   ? a
                           : k == 1 ? b
                           : a > b  ? ((8 - k) * a + (k - 1) * b) / 7
                           : k == 6 ? 0
                           : k == 7 ? 255
                                    : ((6 - k) * a + (k - 1) * b) / 5;
      bc4_most = std::max(bc4_most, std::abs(value - reds[i]));
    }
  }
  EXPECT_LE(bc1_most, 2.2);
  EXPECT_LE(bc4_most, 2.2);
}

TEST(BlockCompression, HoldsWhatTheFormatHolds) {
  for (const BlockQuality quality : kQualities) {
    for (const int value : {0, 1, 77, 254, 255}) {
      std::array<uint8_t, 16> flat;
      flat.fill(static_cast<uint8_t>(value));
      EXPECT_EQ(DecodeBc4(EncodeBc4(flat, AllAlike(), quality)), flat);
    }
    std::array<uint8_t, 16> two;
    for (int i = 0; i < 16; ++i) two[i] = i % 3 == 0 ? 30 : 91;
    EXPECT_EQ(DecodeBc4(EncodeBc4(two, AllAlike(), quality)), two);
    std::array<uint8_t, 16> ends;  // 0 and 255 beside a narrow range: the mode of four between
    for (int i = 0; i < 16; ++i) ends[i] = i == 0 ? 0 : i == 1 ? 255 : 100;
    EXPECT_EQ(DecodeBc4(EncodeBc4(ends, AllAlike(), quality)), ends);
    std::array<Rgb, 16> colors;
    for (int i = 0; i < 16; ++i) colors[i] = i % 2 == 0 ? Rgb{0, 255, 0} : Rgb{255, 0, 255};
    EXPECT_EQ(DecodeBc1(EncodeBc1(colors, AllAlike(), {1, 1, 1}, quality)), colors);
  }
}

// All pairs of end points in both orders: the best that BC4 can do.
double BestBc4Error(const std::array<uint8_t, 16>& texels) {
  double best = HUGE_VAL;
  for (int first = 0; first < 256; ++first) {
    for (int second = 0; second < 256; ++second) {
      // Each of the eight values is read off a decoded block.
      Block block{static_cast<uint8_t>(first), static_cast<uint8_t>(second)};
      uint64_t bits = 0;
      for (uint64_t k = 0; k < 8; ++k) bits |= k << 3 * k;
      for (int i = 0; i < 6; ++i) block[2 + i] = static_cast<uint8_t>(bits >> 8 * i);
      const std::array<uint8_t, 16> palette = DecodeBc4(block);
      double error = 0;
      for (int i = 0; i < 16 && error < best; ++i) {
        int least = 1 << 20;
        for (int k = 0; k < 8; ++k) {
          least = std::min(least, (palette[k] - texels[i]) * (palette[k] - texels[i]));
        }
        error += least;
      }
      best = std::min(best, error);
    }
  }
  return best;
}

TEST(BlockCompression, Bc4IsNearTheBestThatThereIs) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  std::array<double, 3> sums{};
  double best = 0;
  for (int round = 0; round < 12; ++round) {
    std::array<uint8_t, 16> texels;
    for (int i = 0; i < 16; ++i) {
      const double value = 128 + 6 * (i % 4) + 9 * (i / 4) + 2 * round * normal(random);
      texels[i] = static_cast<uint8_t>(std::clamp(value, 0.0, 255.0));
    }
    best += BestBc4Error(texels);
    for (int q = 0; q < 3; ++q) {
      const Block block = EncodeBc4(texels, AllAlike(), kQualities[q]);
      sums[q] += Error1(texels, DecodeBc4(block), AllAlike());
    }
  }
  EXPECT_LE(sums[1], sums[0]);
  EXPECT_LE(sums[2], sums[1]);
  EXPECT_LE(sums[2], 1.02 * best);
  EXPECT_LE(sums[1], 1.15 * best);
  EXPECT_GE(sums[2], best);
}

TEST(BlockCompression, QualityAndWeightsLowerTheErrorTheyCount) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::array<double, 3> sums{};
  double alike_first = 0, weighted_first = 0, masked = 0;
  for (int round = 0; round < 60; ++round) {
    std::array<Rgb, 16> texels;
    TexelWeights half = AllAlike();
    for (int i = 0; i < 16; ++i) {
      for (int c = 0; c < 3; ++c) {
        // Three hat functions, as in a surface page: no line in RGB space.
        const double hats[] = {i % 4 / 3.0, i / 4 / 3.0, 1 - i % 4 / 6.0 - i / 4 / 6.0};
        const double value = 100 + 80 * hats[c] + 8 * normal(random);
        texels[i][c] = static_cast<uint8_t>(std::clamp(value, 0.0, 255.0));
      }
      half[i] = i < 8 ? 1.f : 0.f;
    }
    for (int q = 0; q < 3; ++q) {
      sums[q] += Error3(texels, DecodeBc1(EncodeBc1(texels, AllAlike(), {1, 1, 1}, kQualities[q])));
    }
    const auto first_counts =
        DecodeBc1(EncodeBc1(texels, AllAlike(), {100, 1, 1}, BlockQuality::kGood));
    const auto all_alike = DecodeBc1(EncodeBc1(texels, AllAlike(), {1, 1, 1}, BlockQuality::kGood));
    weighted_first += Error3(texels, first_counts, {1, 0, 0});
    alike_first += Error3(texels, all_alike, {1, 0, 0});
    const auto upper = DecodeBc1(EncodeBc1(texels, half, {1, 1, 1}, BlockQuality::kGood));
    for (int i = 0; i < 8; ++i) {
      for (int c = 0; c < 3; ++c) {
        masked +=
            std::pow(upper[i][c] - texels[i][c], 2) - std::pow(all_alike[i][c] - texels[i][c], 2);
      }
    }
  }
  EXPECT_LT(sums[1], 0.95 * sums[0]);
  EXPECT_LE(sums[2], 1.001 * sums[1]);
  EXPECT_LT(weighted_first, 0.5 * alike_first);
  EXPECT_LT(masked, 0);
}

TEST(BlockCompression, PagesComeBackInPlace) {
  Image page(12, 8, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 12; ++x) {
      for (int c = 0; c < 3; ++c)
        page.At<uint8_t>(x, y, c) =
            static_cast<uint8_t>(20 * (x / 4) + 60 * (y / 4) + 5 * c + x % 2);
    }
  }
  for (const BlockFormat format : {BlockFormat::kBc1, BlockFormat::kBc4}) {
    const BlockPage blocks = EncodePage(page, format, {}, BlockQuality::kGood);
    EXPECT_EQ(blocks.blocks.size(), format == BlockFormat::kBc1 ? 48u : 144u);
    const Image back = DecodePage(blocks);
    for (int y = 0; y < 8; ++y) {
      for (int x = 0; x < 12; ++x) {
        for (int c = 0; c < 3; ++c) {
          EXPECT_NEAR(back.At<uint8_t>(x, y, c), page.At<uint8_t>(x, y, c),
                      format == BlockFormat::kBc1 ? 6 : 0);
        }
      }
    }
  }
  Image odd(10, 8, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  EXPECT_THROW(EncodePage(odd, BlockFormat::kBc1, {}, BlockQuality::kGood), Error);
  EXPECT_THROW(EncodePage(page, BlockFormat::kBc1, {{1, 2}, {}}, BlockQuality::kGood), Error);
  BlockPage cut = EncodePage(page, BlockFormat::kBc1, {}, BlockQuality::kFast);
  cut.blocks.pop_back();
  EXPECT_THROW(DecodePage(cut), Error);
  cut.blocks.clear();
  cut.width = 0;
  EXPECT_THROW(DecodePage(cut), Error);
}

}  // namespace
}  // namespace lfm::testing
