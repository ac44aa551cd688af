// SPDX-License-Identifier: BSD-3-Clause
#include "core/patch_sizes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lfm {
namespace {

TEST(ChooseEdgeSamples, KeepsNearThePixelsInNestedSizes) {
  for (double pixels = 10; pixels < 12000; pixels *= 1.1) {
    const int n = ChooseEdgeSamples(pixels, 257);
    EXPECT_GE(PatchSampleCount(n), pixels);
    EXPECT_LE(PatchSampleCount(n), 4.2 * pixels);
    int segments = n - 1;
    while (segments % 2 == 0) segments /= 2;
    EXPECT_EQ(segments, 3);
  }
  EXPECT_EQ(ChooseEdgeSamples(209, 65), 25);
  EXPECT_EQ(ChooseEdgeSamples(1e30, 65), 49);
  EXPECT_EQ(ChooseEdgeSamples(1e30, 1000), 193);
  EXPECT_EQ(ChooseEdgeSamples(0, 65), 4);
  EXPECT_EQ(ChooseEdgeSamples(std::nan(""), 65), 4);
}

}  // namespace
}  // namespace lfm
