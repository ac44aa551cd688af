// SPDX-License-Identifier: BSD-3-Clause
#include "scan/gray_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <utility>
#include <vector>

#include "core/image.h"

namespace lfm::kernels {
namespace {

constexpr GrayNoise kNoise = {1e-5F, 1e-4F, 2, 0, 1};

/// Frames of random values; black below white, pattern and inverse anywhere.
template <typename T>
struct RandomFrames {
  std::vector<T> white, black;
  std::vector<std::vector<T>> patterns, inverses;
  std::vector<const T*> pattern, inverse;
  std::vector<float> contrast;
  std::vector<uint8_t> usable;

  RandomFrames(int bits, size_t pixels, std::mt19937& random)
      : white(pixels), black(pixels), contrast(pixels), usable(pixels) {
    std::uniform_int_distribution<int> level(0, 255);
    const auto value = [&](int l) { return static_cast<T>(sizeof(T) == 1 ? l : l / 255.0); };
    for (size_t p = 0; p < pixels; ++p) {
      const int a = level(random), b = level(random);
      white[p] = value(std::max(a, b));
      black[p] = value(std::min(a, b) / 2);
      contrast[p] = Linear(white[p]) - Linear(black[p]);
      usable[p] = contrast[p] > 0.03F && a % 7 != 0;
    }
    for (int bit = 0; bit < bits; ++bit) {
      for (auto* frames : {&patterns, &inverses}) {
        frames->emplace_back(pixels);
        for (T& v : frames->back()) v = value(level(random));
      }
    }
    for (const auto& frame : patterns) pattern.push_back(frame.data());
    for (const auto& frame : inverses) inverse.push_back(frame.data());
  }

  static float Linear(T v) { return sizeof(T) == 1 ? LinearFromSrgb(v / 255.0F) : v; }
  GrayPlanes<T> Planes() const {
    return {white.data(), black.data(), pattern.data(), inverse.data(),
            static_cast<int>(pattern.size())};
  }
};

/// What gray_kernel.h says of a cell and its two edges, bit by bit.
template <typename T>
void ExpectReading(const RandomFrames<T>& frames, const GrayReading& reading, size_t p) {
  const int bits = static_cast<int>(frames.pattern.size());
  int code = 0, other = -1;
  for (int bit = bits - 1, digit = 0; bit >= 0; --bit) {
    const size_t b = static_cast<size_t>(bit);
    const bool on = frames.pattern[b][p] > frames.inverse[b][p];
    digit ^= on ? 1 : 0;
    code |= digit << bit;
    if (on) other = bit + 1;
  }
  EXPECT_EQ(reading.cell[p], code);
  const auto difference = [&](int bit) {
    if (bit < 0 || bit == bits) return std::abs(frames.contrast[p]);
    const size_t b = static_cast<size_t>(bit);
    return std::abs(RandomFrames<T>::Linear(frames.pattern[b][p]) -
                    RandomFrames<T>::Linear(frames.inverse[b][p]));
  };
  if (frames.contrast[p] < 0.03F) return;
  const float f = difference(0), o = difference(other);
  constexpr float kLinear_abs = 2e-3F;
  EXPECT_NEAR(reading.strength[p] * frames.contrast[p], f + o, kLinear_abs);
  EXPECT_NEAR(reading.balance[p] * (f + o), o - f, kLinear_abs);
}

template <typename T>
void ExpectAllAgree(int bits, int count, std::mt19937& random) {
  const RandomFrames<T> frames(bits, static_cast<size_t>(count), random);
  GrayPlacing placing{};
  GrayInterval intervals[kGrayIntervals];
  for (int i = 0; i < kGrayIntervals; ++i) {
    intervals[i] = {static_cast<float>(i) / kGrayIntervals, 0.5F, 1e-4F};
  }
  placing.size = 1 << bits;
  placing.cell_px = 1;
  SetIntervals(intervals, placing);
  placing.min_weakest = placing.min_strength = placing.min_direct = 0.05F;
  GrayReading first_reading, reading;
  GrayPlaces first, places;
  for (int k = 0; GrayKernelsHere(k) != nullptr; ++k) {
    ReadGray(frames.Planes(), kNoise, frames.contrast.data(), 0, count, reading,
             *GrayKernelsHere(k));
    DecodeGray(frames.Planes(), kNoise, placing, frames.contrast.data(), frames.usable.data(), 0,
               count, places, *GrayKernelsHere(k));
    for (size_t p = 0; p < static_cast<size_t>(count); ++p) ExpectReading(frames, reading, p);
    if (k == 0) std::swap(first, places), std::swap(first_reading, reading);
    if (k == 0) continue;
    const size_t bytes = static_cast<size_t>(count) * sizeof(float);
    EXPECT_EQ(std::memcmp(first.position, places.position, bytes), 0) << bits << " " << count;
    EXPECT_EQ(std::memcmp(first.sigma, places.sigma, bytes), 0) << bits << " " << count;
    EXPECT_EQ(std::memcmp(first.confidence, places.confidence, bytes), 0) << bits << " " << count;
    EXPECT_EQ(std::memcmp(first_reading.weakest, reading.weakest, bytes), 0);
    EXPECT_EQ(std::memcmp(first_reading.direct, reading.direct, bytes), 0);
  }
}

TEST(GrayKernel, EveryInstructionSetReadsWhatTheBitsSay) {
  std::mt19937 random(3);
  for (int bits = 1; bits <= 16; ++bits) {
    for (const int count : {1, 7, 31, 32, 33, 200, 255, 256}) {
      ExpectAllAgree<uint8_t>(bits, count, random);
      ExpectAllAgree<float>(bits, count, random);
    }
  }
}

TEST(GrayKernel, AClippedPixelIsNotFit) {
  std::mt19937 random(4);
  RandomFrames<uint8_t> frames(3, kGrayBlock, random);
  for (int p = 0; p < kGrayBlock; ++p) frames.white[static_cast<size_t>(p)] = p % 2 ? 254 : 253;
  for (auto* side : {&frames.patterns, &frames.inverses}) {
    for (auto& frame : *side) {
      for (uint8_t& v : frame) v = std::min<uint8_t>(v, 253);
    }
  }
  GrayReading reading;
  for (int k = 0; GrayKernelsHere(k) != nullptr; ++k) {
    ReadGray(frames.Planes(), kNoise, frames.contrast.data(), 0, kGrayBlock, reading,
             *GrayKernelsHere(k));
    for (int p = 0; p < kGrayBlock; ++p) EXPECT_EQ(reading.fit[p] != 0, p % 2 == 0);
  }
}

TEST(GrayKernel, LightIsThatOfTheLevels) {
  std::vector<float> table(256);
  for (size_t i = 0; i < 256; ++i) table[i] = LinearFromSrgb(static_cast<float>(i) / 255);
  std::mt19937 random(5);
  std::uniform_int_distribution<int> level(0, 255);
  std::vector<uint8_t> lit(kGrayBlock), dark(kGrayBlock);
  for (uint8_t& v : lit) v = static_cast<uint8_t>(level(random));
  for (uint8_t& v : dark) v = static_cast<uint8_t>(level(random));
  lit[0] = 254;
  dark[1] = 255;
  constexpr float kLeast = 0.1F;
  GrayLight light;
  for (int k = 0; GrayKernelsHere(k) != nullptr; ++k) {
    ReadGrayLight(table.data(), lit.data(), dark.data(), kLeast, kGrayBlock, light,
                  *GrayKernelsHere(k));
    for (size_t p = 0; p < kGrayBlock; ++p) {
      EXPECT_EQ(light.white[p], table[lit[p]]);
      EXPECT_EQ(light.contrast[p], table[lit[p]] - table[dark[p]]);
      EXPECT_EQ(light.usable[p] != 0,
                light.contrast[p] >= kLeast && std::max(lit[p], dark[p]) < 254);
    }
  }
}

/// Positions of which a fifth are nowhere and a fifth are far from their neighbours.
std::vector<float> RandomPositions(size_t pixels, std::mt19937& random) {
  std::uniform_int_distribution<int> kind(0, 4);
  std::vector<float> positions(pixels);
  for (size_t p = 0; p < pixels; ++p) {
    const int k = kind(random);
    positions[p] = k == 0 ? kNowhere : k == 1 ? 100.0F * static_cast<float>(p) : 5.0F;
  }
  return positions;
}

TEST(GrayKernel, IslandsAreRejectedRowByRowAsAllAtOnce) {
  std::mt19937 random(6);
  for (const auto& [width, height] :
       {std::pair{1L, 1L}, {1L, 9L}, {9L, 1L}, {2L, 2L}, {8L, 5L}, {37L, 11L}}) {
    const size_t pixels = static_cast<size_t>(width * height);
    const std::vector<float> positions = RandomPositions(pixels, random);
    constexpr float kReach = 4;
    const auto near = [&](long x, long y, float at) {
      if (x < 0 || y < 0 || x >= width || y >= height) return false;
      return std::abs(positions[static_cast<size_t>(y * width + x)] - at) <= kReach;
    };
    for (int k = 0; GrayKernelsHere(k) != nullptr; ++k) {
      for (const long rows : {1L, 3L, height + 1}) {
        std::vector<float> position = positions, sigma(pixels, 1), confidence(pixels, 1);
        std::vector<int32_t> kept(2 * static_cast<size_t>(width));
        const GrayRaster raster{width, height, position.data(), sigma.data(), confidence.data()};
        for (long y = 0; y < height + 1; y += rows) {
          RejectIslands(raster, y, std::min(y + rows, height + 1), kReach, kept.data(),
                        *GrayKernelsHere(k));
        }
        for (size_t p = 0; p < pixels; ++p) {
          const long x = static_cast<long>(p) % width, y = static_cast<long>(p) / width;
          const float at = positions[p];
          const bool stays = at > kNowhere && (near(x - 1, y, at) || near(x + 1, y, at) ||
                                               near(x, y - 1, at) || near(x, y + 1, at));
          EXPECT_EQ(confidence[p], stays ? 1.0F : 0.0F);
          EXPECT_EQ(sigma[p], stays ? 1.0F : 0.0F);
          EXPECT_EQ(position[p], stays ? at : 0.0F);
        }
      }
    }
  }
}

}  // namespace
}  // namespace lfm::kernels
