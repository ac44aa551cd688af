// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/sensor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/image.h"
#include "sample_data/random.h"

namespace lfm {
namespace {

TEST(Sensor, NoiseHasTheStatedMeanAndVariance) {
  const Sensor sensor;
  constexpr int kCount = 200000;
  for (float value : {0.0f, 0.01f, 0.2f, 0.9f}) {
    RandomStream random(5, 1, 2);
    double sum = 0, squares = 0;
    for (int i = 0; i < kCount; ++i) {
      const double x = NoisyValue(sensor, value, random.Normal());
      sum += x;
      squares += x * x;
    }
    const double mean = sum / kCount, variance = squares / kCount - mean * mean;
    // Shot noise: as many electrons of variance as electrons; read noise 5 electrons.
    const double expected = (value * 20000.0 + 25.0) / (20000.0 * 20000.0);
    EXPECT_NEAR(mean, value, 5 * std::sqrt(expected / kCount));
    EXPECT_NEAR(variance / expected, 1, 5 * std::sqrt(2.0 / kCount)) << value;
  }
}

TEST(Sensor, EncodesToTheNearestLevel) {
  for (int level = 0; level < 256; ++level) {
    EXPECT_EQ(EncodeSrgb8(LinearFromSrgb(static_cast<float>(level) / 255)), level);
  }
  EXPECT_EQ(EncodeSrgb8(-1), 0);
  EXPECT_EQ(EncodeSrgb8(7), 255);
  EXPECT_EQ(EncodeSrgb8(std::nanf("")), 0);
}

TEST(Sensor, SaturatesAndIsRepeatable) {
  const std::vector<float> linear = {0, 0.5f, 2, 0.5f};
  std::vector<uint8_t> a(4), b(4), other(4);
  ExposeRow({}, linear.data(), 4, 1, 2, 3, a.data());
  ExposeRow({}, linear.data(), 4, 1, 2, 3, b.data());
  ExposeRow({}, linear.data(), 4, 1, 2, 4, other.data());
  EXPECT_EQ(a, b);
  EXPECT_NE(a, other);
  EXPECT_EQ(a[2], 255);
  EXPECT_NEAR(a[1], 188, 8);
}

TEST(RandomStream, IsUniformAndNormal) {
  RandomStream random(1, 2, 3);
  double mean = 0, mean2 = 0, normal2 = 0, normal4 = 0;
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i) {
    const double u = random.Uniform(), n = random.Normal();
    EXPECT_TRUE(u >= 0 && u < 1);
    mean += u / kCount;
    mean2 += u * u / kCount;
    normal2 += n * n / kCount;
    normal4 += n * n * n * n / kCount;
  }
  EXPECT_NEAR(mean, 0.5, 0.005);
  EXPECT_NEAR(mean2, 1.0 / 3, 0.005);
  EXPECT_NEAR(normal2, 1, 0.025);
  EXPECT_NEAR(normal4, 3, 0.2);
}

}  // namespace
}  // namespace lfm
