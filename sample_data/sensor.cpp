// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/sensor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sample_data/random.h"

namespace lfm {
namespace {

constexpr int kTableSize = 1 << 16;

std::array<uint8_t, kTableSize> MakeSrgbTable() {
  std::array<uint8_t, kTableSize> table{};
  for (int i = 0; i < kTableSize; ++i) {
    const float linear = (static_cast<float>(i) + 0.5f) / kTableSize;
    table[i] = static_cast<uint8_t>(std::lround(255 * SrgbFromLinear(linear)));
  }
  return table;
}

}  // namespace

uint8_t EncodeSrgb8(float linear) {
  static const std::array<uint8_t, kTableSize> table = MakeSrgbTable();
  if (!(linear > 0)) return 0;
  return table[std::min(kTableSize - 1, static_cast<int>(std::min(linear, 1.0f) * kTableSize))];
}

double NoiseVariance(const Sensor& sensor, float value) {
  const double read = sensor.read_noise / sensor.full_well;
  return value / sensor.full_well + read * read;
}

float NoisyValue(const Sensor& sensor, float value, double normal) {
  return static_cast<float>(value + std::sqrt(NoiseVariance(sensor, value)) * normal);
}

void ExposeRow(const Sensor& sensor, const float* linear, int count, uint64_t seed,
               uint64_t picture, uint64_t row, uint8_t* out) {
  RandomStream random(seed, picture, row);
  for (int i = 0; i < count; ++i) {
    out[i] = EncodeSrgb8(NoisyValue(sensor, std::max(0.0f, linear[i]), random.Normal()));
  }
}

void ExposeRowLinear(const Sensor& sensor, const float* linear, int count, uint64_t seed,
                     uint64_t picture, uint64_t row, float* out) {
  RandomStream random(seed, picture, row);
  for (int i = 0; i < count; ++i) {
    out[i] = std::min(1.0f, NoisyValue(sensor, std::max(0.0f, linear[i]), random.Normal()));
  }
}

}  // namespace lfm
