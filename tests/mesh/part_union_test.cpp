// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/part_union.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "core/error.h"
#include "mesh/self_intersection.h"
#include "tests/core/mesh_zoo.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

std::optional<TriangleMesh> Unite(const TriangleMesh& mesh) {
  auto united = UniteParts(mesh, SilentProgress());
  if (!united) return {};
  return std::move(united->mesh);
}

TEST(PartUnion, BoxesThatCrossAreOneBody) {
  const TriangleMesh crossing =
      Join(test::MakeBox({0, 0, 0}, {10, 10, 10}, 2), test::MakeBox({5, 1, 1}, {20, 9, 9}, 2));
  const auto united = Unite(crossing);
  ASSERT_TRUE(united);
  EXPECT_TRUE(test::IsClosedManifold(*united));
  EXPECT_EQ(ExamineTopology(*united).components, 1);
  EXPECT_TRUE(FindSelfIntersections(*united).empty());
  EXPECT_NEAR(SignedVolume(*united), 1000 + 10 * 64, 1e-9);
}

TEST(PartUnion, BallsThatCrossHaveTheVolumeOfTheLens) {
  const double radius = 30, apart = 20;
  const auto united = Unite(
      Join(test::MakeSphere(radius, 5, {0, 0, 40}), test::MakeSphere(radius, 5, {apart, 0, 40})));
  ASSERT_TRUE(united);
  const double ball = 4.0 / 3 * std::numbers::pi * std::pow(radius, 3);
  const double lens =
      std::numbers::pi / 12 * (4 * radius + apart) * std::pow(2 * radius - apart, 2);
  EXPECT_NEAR(SignedVolume(*united) / (2 * ball - lens), 1, 2e-3);
}

TEST(PartUnion, PartsThatMeetNoOtherStay) {
  const TriangleMesh crossing =
      Join(test::MakeBox({0, 0, 0}, {10, 10, 10}, 2), test::MakeBox({5, 1, 1}, {20, 9, 9}, 2));
  const TriangleMesh apart = test::MakeSphere(5, 2, {100, 0, 0}),
                     inside = test::MakeBox({1, 1, 1}, {2, 2, 2}, 1);
  TriangleMesh open = test::MakeSphere(5, 2, {0, 100, 0});
  open.triangles.pop_back();
  const auto united = UniteParts(Join(Join(apart, crossing), Join(inside, open)), SilentProgress());
  ASSERT_TRUE(united);
  EXPECT_EQ(united->united, 2);
  EXPECT_EQ(ExamineTopology(united->mesh).components, 4);
  EXPECT_EQ(united->mesh.triangles.size(), Unite(crossing)->triangles.size() +
                                               apart.triangles.size() + inside.triangles.size() +
                                               open.triangles.size());
  EXPECT_FALSE(Unite(Join(apart, Join(inside, open))));
}

TEST(PartUnion, ManyPartsInAnyOrder) {
  TriangleMesh chain = test::MakeSphere(10, 3);
  for (const int i : {3, 1, 5, 2, 4}) {
    chain = Join(chain, test::MakeSphere(10, 2, {15.0 * i + 0.1, 0.3 * i, 0}));
  }
  const auto united = Unite(chain);
  ASSERT_TRUE(united);
  EXPECT_TRUE(test::IsClosedManifold(*united));
  EXPECT_EQ(ExamineTopology(*united).components, 1);
}

TEST(PartUnion, NothingWhereNoneIsDefined) {
  const TriangleMesh ball = test::MakeSphere(30, 2);
  EXPECT_FALSE(Unite(ball));
  TriangleMesh open = test::MakeSphere(10, 2, {30, 0, 0});
  open.triangles.pop_back();
  EXPECT_FALSE(Unite(Join(ball, open)));
  TriangleMesh cavity = test::MakeSphere(10, 2, {30, 0, 0});
  for (Eigen::Vector3i& t : cavity.triangles) std::swap(t[1], t[2]);
  EXPECT_FALSE(Unite(Join(ball, cavity)));
}

TEST(PartUnion, APartWithALargeFoldStays) {
  TriangleMesh folded = test::MakeSphere(10, 3, {30, 0, 0});
  // Pushed through its neighbour.
  const Eigen::Vector3i t = folded.triangles[0];
  folded.vertices[t[0]] +=
      1.6 * (folded.vertices[t[1]] - folded.vertices[t[0]]) - Eigen::Vector3d(0.3, 0.2, 0.1);
  ASSERT_FALSE(FindSelfIntersections(folded).empty());
  // Its crossings could be parted, but not without changing its shape.
  EXPECT_EQ(RemoveSelfIntersections(folded).left, 0);
  EXPECT_FALSE(Unite(Join(test::MakeSphere(30, 2), folded)));
}

TEST(PartUnion, TouchingAlongAnEdgeOnlyIsNoManifold) {
  EXPECT_FALSE(Unite(Join(test::MakeBox({0, 0, 0}, {10, 10, 10}, 1),
                          test::MakeBox({10, 10, 0}, {20, 20, 10}, 1))));
}

TEST(PartUnion, InvalidIsAnError) {
  EXPECT_THROW(Unite({}), Error);
  TriangleMesh broken = test::MakeSphere(30, 1);
  broken.vertices[3].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Unite(broken), Error);
}

}  // namespace
}  // namespace lfm
