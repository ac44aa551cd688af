// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/part_union.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/error.h"
#include "mesh/self_intersection.h"
#include "tests/core/mesh_zoo.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

TEST(PartUnion, BoxesThatCrossAreOneBody) {
  const TriangleMesh crossing =
      Join(test::MakeBox({0, 0, 0}, {10, 10, 10}, 2), test::MakeBox({5, 1, 1}, {20, 9, 9}, 2));
  const auto united = UniteParts(crossing);
  ASSERT_TRUE(united);
  EXPECT_TRUE(test::IsClosedManifold(*united));
  EXPECT_EQ(ExamineTopology(*united).components, 1);
  EXPECT_TRUE(FindSelfIntersections(*united).empty());
  EXPECT_NEAR(SignedVolume(*united), 1000 + 10 * 64, 1e-9);
}

TEST(PartUnion, BallsThatCrossHaveTheVolumeOfTheLens) {
  const double radius = 30, apart = 20;
  const auto united = UniteParts(
      Join(test::MakeSphere(radius, 5, {0, 0, 40}), test::MakeSphere(radius, 5, {apart, 0, 40})));
  ASSERT_TRUE(united);
  const double ball = 4.0 / 3 * std::numbers::pi * std::pow(radius, 3);
  const double lens =
      std::numbers::pi / 12 * (4 * radius + apart) * std::pow(2 * radius - apart, 2);
  EXPECT_NEAR(SignedVolume(*united) / (2 * ball - lens), 1, 2e-3);
}

TEST(PartUnion, APartInsideAnotherGoesAndOneApartStays) {
  const TriangleMesh outer = test::MakeSphere(30, 3), inner = test::MakeSphere(5, 2);
  const auto without = UniteParts(Join(outer, inner));
  ASSERT_TRUE(without);
  EXPECT_EQ(without->triangles.size(), outer.triangles.size());
  const auto both = UniteParts(Join(outer, Moved(inner, {100, 0, 0})));
  ASSERT_TRUE(both);
  EXPECT_EQ(both->triangles.size(), outer.triangles.size() + inner.triangles.size());
}

TEST(PartUnion, ManyPartsInAnyOrder) {
  TriangleMesh chain = test::MakeSphere(10, 3);
  for (const int i : {3, 1, 5, 2, 4}) {
    chain = Join(chain, test::MakeSphere(10, 2, {15.0 * i + 0.1, 0.3 * i, 0}));
  }
  const auto united = UniteParts(chain);
  ASSERT_TRUE(united);
  EXPECT_TRUE(test::IsClosedManifold(*united));
  EXPECT_EQ(ExamineTopology(*united).components, 1);
}

TEST(PartUnion, NothingWhereNoneIsDefined) {
  const TriangleMesh ball = test::MakeSphere(30, 2);
  EXPECT_FALSE(UniteParts(ball));
  TriangleMesh open = test::MakeSphere(10, 2, {30, 0, 0});
  open.triangles.pop_back();
  EXPECT_FALSE(UniteParts(Join(ball, open)));
  TriangleMesh cavity = test::MakeSphere(10, 2);
  for (Eigen::Vector3i& t : cavity.triangles) std::swap(t[1], t[2]);
  EXPECT_FALSE(UniteParts(Join(ball, cavity)));
}

TEST(PartUnion, APartWithASmallFoldIsPartedFirst) {
  TriangleMesh folded = test::MakeSphere(10, 3, {30, 0, 0});
  // Pushed through its neighbour.
  const Eigen::Vector3i t = folded.triangles[0];
  folded.vertices[t[0]] +=
      1.6 * (folded.vertices[t[1]] - folded.vertices[t[0]]) - Eigen::Vector3d(0.3, 0.2, 0.1);
  ASSERT_FALSE(FindSelfIntersections(folded).empty());
  const auto united = UniteParts(Join(test::MakeSphere(30, 2), folded));
  ASSERT_TRUE(united);
  EXPECT_TRUE(test::IsClosedManifold(*united));
  EXPECT_TRUE(FindSelfIntersections(*united).empty());
}

TEST(PartUnion, TouchingAlongAnEdgeOnlyIsNoManifold) {
  EXPECT_FALSE(UniteParts(Join(test::MakeBox({0, 0, 0}, {10, 10, 10}, 1),
                               test::MakeBox({10, 10, 0}, {20, 20, 10}, 1))));
}

TEST(PartUnion, InvalidIsAnError) {
  EXPECT_THROW(UniteParts({}), Error);
  TriangleMesh broken = test::MakeSphere(30, 1);
  broken.vertices[3].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(UniteParts(broken), Error);
}

}  // namespace
}  // namespace lfm
