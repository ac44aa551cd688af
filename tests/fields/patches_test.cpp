// SPDX-License-Identifier: BSD-3-Clause
#include "fields/patches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/error.h"

namespace lfm {
namespace {

std::vector<uint8_t> AllOf(int count) { return std::vector<uint8_t>(count, 1); }

TEST(Patches, SquaresAreWholeRings) {
  const NestedPatches patches =
      PixelPatches(21, 21, AllOf(441), 10 * 21 + 10, PatchShape::kSquare, {1, 300, 1});
  EXPECT_EQ(patches.center, 220);
  EXPECT_EQ(patches.points.front(), 220);
  for (const int64_t size : patches.sizes) {
    const auto side = std::llround(std::sqrt(size));
    EXPECT_EQ(side * side, size);
    EXPECT_EQ(side % 2, 1);
    for (int64_t i = 0; i < size; ++i) {
      EXPECT_LE(std::abs(patches.points[i] % 21 - 10), side / 2);
      EXPECT_LE(std::abs(patches.points[i] / 21 - 10), side / 2);
    }
  }
  EXPECT_EQ(patches.sizes, (std::vector<int64_t>{1, 9, 25, 49, 81, 169, 289}));
}

TEST(Patches, DiscsGrowByOctaves) {
  const int side = 101;
  const NestedPatches patches = PixelPatches(side, side, AllOf(side * side), 50 * side + 50,
                                             PatchShape::kDisc, {16, 4096, 2});
  ASSERT_EQ(patches.sizes.size(), 17u);
  for (size_t i = 0; i < patches.sizes.size(); ++i) {
    const double wanted = 16 * std::exp2(i / 2.0);
    EXPECT_GE(patches.sizes[i], std::floor(wanted));
    EXPECT_LE(patches.sizes[i], wanted + 24);  // a ring of equal distance
    // A disc's radius.
    const int64_t last = patches.points[patches.sizes[i] - 1];
    const double radius = std::hypot(last % side - 50.0, last / side - 50.0);
    EXPECT_NEAR(radius, std::sqrt(static_cast<double>(patches.sizes[i]) / M_PI), 1);
  }
  EXPECT_EQ(std::set<int64_t>(patches.points.begin(), patches.points.end()).size(),
            patches.points.size());
}

TEST(Patches, OnlyOccupiedPixelsAreTaken) {
  std::vector<uint8_t> occupied = AllOf(100);
  for (int i = 0; i < 100; ++i) occupied[i] = i % 10 < 5;
  const NestedPatches patches = PixelPatches(10, 10, occupied, 4, PatchShape::kDisc, {1, 100, 1});
  EXPECT_LE(patches.sizes.back(), 50);
  for (const int64_t point : patches.points) EXPECT_LT(point % 10, 5);
  EXPECT_THROW(PixelPatches(10, 10, occupied, 7, PatchShape::kDisc, {1, 100, 1}), Error);
}

// A strip of triangles bent back on itself: its ends are close in space, far along the edges.
TEST(Patches, EdgesKeepFoldsApart) {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3i> triangles;
  const int count = 40;
  for (int i = 0; i < count; ++i) {
    const float turn = 6.0f * static_cast<float>(i) / count;
    for (const float z : {0.0f, 0.3f}) {
      positions.emplace_back(5 * std::cos(turn), 5 * std::sin(turn), z);
    }
    if (i > 0) {
      triangles.emplace_back(2 * i - 2, 2 * i - 1, 2 * i);
      triangles.emplace_back(2 * i, 2 * i - 1, 2 * i + 1);
    }
  }
  const PatchAreas areas{1, 16, 1};
  const auto last = [](const std::vector<int64_t>& points) {
    return *std::max_element(points.begin(), points.end());
  };
  EXPECT_EQ(last(VertexPatches(positions, AllOf(80), 0, areas).points), 79);
  const NestedPatches along = GeodesicPatches(positions, triangles, AllOf(80), 0, areas);
  ASSERT_EQ(along.sizes.back(), 16);
  EXPECT_LT(last(along.points), 20);
  // What no edge leads to is not reached.
  positions.emplace_back(5, 0.1, 0);
  EXPECT_EQ(GeodesicPatches(positions, triangles, AllOf(81), 0, {1, 81, 1}).sizes.back(), 64);
  EXPECT_THROW(GeodesicPatches(positions, {{0, 1, 99}}, AllOf(81), 0, areas), Error);
}

TEST(Patches, CentersAreSpread) {
  std::vector<Eigen::Vector3f> places;
  for (int i = 0; i < 1024; ++i) {
    places.emplace_back(static_cast<float>(i % 32), static_cast<float>(i / 32), 0);
  }
  std::vector<uint8_t> occupied = AllOf(1024);
  const auto centers = SpreadCenters(places, occupied, 4);
  std::set<int> quadrants;
  for (const int64_t center : centers) {
    quadrants.insert(2 * (center % 32 >= 16) + (center / 32 >= 16));
  }
  EXPECT_EQ(quadrants.size(), 4u);
  std::fill(occupied.begin(), occupied.end(), 0);
  EXPECT_TRUE(SpreadCenters(places, occupied, 4).empty());
  occupied[700] = 1;
  EXPECT_EQ(SpreadCenters(places, occupied, 4), std::vector<int64_t>{700});
}

TEST(Patches, Extremes) {
  const NestedPatches one = PixelPatches(1, 1, {1}, 0, PatchShape::kDisc, {1, 4096, 2});
  EXPECT_EQ(one.sizes, std::vector<int64_t>{1});
  EXPECT_TRUE(PixelPatches(3, 3, AllOf(9), 4, PatchShape::kDisc, {16, 64, 1}).sizes.empty());
  EXPECT_THROW(PixelPatches(3, 3, AllOf(8), 4, PatchShape::kDisc, {}), Error);
  EXPECT_THROW(PixelPatches(3, 3, AllOf(9), 9, PatchShape::kDisc, {}), Error);
  EXPECT_THROW(PixelPatches(3, 3, AllOf(9), 4, PatchShape::kDisc, {8, 4, 1}), Error);
  // All in one place: one ring.
  const std::vector<Eigen::Vector3f> same(5, Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(VertexPatches(same, AllOf(5), 2, {1, 5, 1}).sizes, std::vector<int64_t>{5});
}

}  // namespace
}  // namespace lfm
