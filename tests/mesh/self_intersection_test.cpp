// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/self_intersection.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/core/mesh_zoo.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

TEST(SelfIntersection, SoundShapesHaveNone) {
  EXPECT_TRUE(FindSelfIntersections(test::MakeSphere(30, 3)).empty());
  EXPECT_TRUE(FindSelfIntersections(test::MakeTorus(30, 10, 10, 40, 20)).empty());
  EXPECT_TRUE(FindSelfIntersections(test::MakeBox({0, 0, 0}, {1, 2, 3}, 3)).empty());
}

TEST(SelfIntersection, ASpikeThroughTheBallIsFoundAndTakenBack) {
  TriangleMesh mesh = test::MakeSphere(30, 3, {0, 0, 40});
  mesh.vertices[7] =
      2 * Eigen::Vector3d(0, 0, 40) - 1.2 * (mesh.vertices[7] - Eigen::Vector3d(0, 0, 40));
  EXPECT_FALSE(FindSelfIntersections(mesh).empty());
  const Untangled untangled = RemoveSelfIntersections(mesh);
  EXPECT_EQ(untangled.left, 0);
  EXPECT_TRUE(FindSelfIntersections(untangled.mesh).empty());
  EXPECT_TRUE(untangled.mesh.triangles == mesh.triangles);
  EXPECT_TRUE(test::IsClosedManifold(untangled.mesh));
  EXPECT_GT(SignedVolume(untangled.mesh), 0.9 * SignedVolume(test::MakeSphere(30, 3)));
}

TEST(SelfIntersection, VerticesOnThePlatformStayThere) {
  TriangleMesh mesh = test::MakeBox({-10, -10, 0}, {10, 10, 20}, 4);
  for (Eigen::Vector3d& v : mesh.vertices) {
    if (v == Eigen::Vector3d(0, 0, 20)) v.z() = -5;
  }
  const Untangled untangled = RemoveSelfIntersections(mesh);
  EXPECT_EQ(untangled.left, 0);
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    EXPECT_EQ(mesh.vertices[v].z() == 0, untangled.mesh.vertices[v].z() == 0);
  }
}

TEST(SelfIntersection, WhatCannotBePartedStaysAsItIs) {
  // Two balls through each other, each far too coarse to give way.
  TriangleMesh mesh = test::MakeSphere(30, 1, {0, 0, 40});
  const TriangleMesh other = test::MakeSphere(30, 1, {20, 0, 40});
  const int first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Eigen::Vector3i& t : other.triangles) {
    mesh.triangles.emplace_back(t[0] + first, t[1] + first, t[2] + first);
  }
  const size_t before = FindSelfIntersections(mesh).size();
  ASSERT_GT(before, 0u);
  const Untangled untangled = RemoveSelfIntersections(mesh);
  EXPECT_LE(untangled.left, static_cast<int>(before));
  EXPECT_EQ(FindSelfIntersections(untangled.mesh).size(), static_cast<size_t>(untangled.left));
}

TEST(SelfIntersection, PairsToBeLeftStay) {
  const TriangleMesh mesh =
      Join(test::MakeSphere(30, 3, {0, 0, 40}), test::MakeSphere(8, 3, {30, 0, 40}));
  const auto before = FindSelfIntersections(mesh);
  ASSERT_FALSE(before.empty());
  const Untangled left = RemoveSelfIntersections(mesh, [](int, int) { return true; });
  EXPECT_EQ(left.left, static_cast<int>(before.size()));
  EXPECT_TRUE(left.mesh.vertices == mesh.vertices);
}

TEST(SelfIntersection, NoManifoldNoAnswer) {
  TriangleMesh fin = test::MakeSphere(30, 1);
  fin.vertices.emplace_back(0, 0, 100);
  fin.triangles.emplace_back(fin.triangles[0][0], fin.triangles[0][1],
                             static_cast<int>(fin.vertices.size()) - 1);
  EXPECT_THROW(FindSelfIntersections(fin), Error);
  EXPECT_THROW(FindSelfIntersections({}), Error);
}

}  // namespace
}  // namespace lfm
