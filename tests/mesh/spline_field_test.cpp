// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/spline_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/error.h"

namespace lfm {
namespace {

// The quadratic B-spline of unit width about 0.
double Spline(double t) {
  t = std::abs(t);
  if (t < 0.5) return 0.75 - t * t;
  if (t < 1.5) return 0.5 * (1.5 - t) * (1.5 - t);
  return 0;
}

double Direct(const SplineField& field, double x, double y, double z) {
  double sum = 0;
  for (size_t d = 0; d < field.levels.size(); ++d) {
    const double h = 1.0 / (1 << d);
    for (const auto& c : field.levels[d]) {
      sum += c.value * Spline(x / h - c.x - 0.5) * Spline(y / h - c.y - 0.5) *
             Spline(z / h - c.z - 0.5);
    }
  }
  return sum;
}

// Cells far enough inside that no support is mirrored at a wall.
SplineField RandomField(int depth, int inset) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> value(-1, 1);
  SplineField field;
  field.levels.resize(depth + 1);
  for (int d = 3; d <= depth; ++d) {
    std::uniform_int_distribution<int> cell(inset, (1 << d) - 1 - inset);
    for (int i = 0; i < 40; ++i) {
      field.levels[d].push_back({cell(random), cell(random), cell(random), value(random)});
    }
  }
  return field;
}

TEST(SplineLayers, AgreeWithTheDirectSum) {
  constexpr int kDepth = 5, kSize = 1 << kDepth;
  const SplineField field = RandomField(kDepth, 2);
  SplineLayers layers(field);
  for (int k = 0; k <= kSize; ++k) {
    const std::vector<float> values = layers.Corners(k);
    ASSERT_EQ(values.size(), static_cast<size_t>(kSize + 1) * (kSize + 1));
    for (int y = 0; y <= kSize; y += 3) {
      for (int x = 0; x <= kSize; x += 3) {
        const double expected =
            Direct(field, static_cast<double>(x) / kSize, static_cast<double>(y) / kSize,
                   static_cast<double>(k) / kSize);
        EXPECT_NEAR(values[static_cast<size_t>(y) * (kSize + 1) + x], expected, 1e-5);
      }
    }
  }
}

// All cells of a level together are the constant 1, up to the mirrored walls.
TEST(SplineLayers, AWholeLevelIsConstant) {
  SplineField field;
  field.levels.resize(5);
  for (int i = 0; i < 512; ++i) field.levels[3].push_back({i % 8, i / 8 % 8, i / 64, 2});
  SplineLayers layers(field);
  for (int k = 0; k <= 16; ++k) {
    for (const float value : layers.Corners(k)) EXPECT_NEAR(value, 2, 1e-5);
  }
}

TEST(SplineLayers, RefusesWhatDoesNotFit) {
  EXPECT_THROW(SplineLayers({}), Error);
  SplineField field;
  field.levels.resize(3);
  field.levels[2].push_back({4, 0, 0, 1});
  EXPECT_THROW(SplineLayers{field}, Error);
  field.levels[2][0] = {0, -1, 0, 1};
  EXPECT_THROW(SplineLayers{field}, Error);
}

}  // namespace
}  // namespace lfm
