// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/manifold_repair.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

TriangleMesh Join(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh joined = a;
  const int offset = static_cast<int>(a.vertices.size());
  joined.vertices.insert(joined.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles) {
    joined.triangles.push_back(t + Eigen::Vector3i::Constant(offset));
  }
  return joined;
}

// Merges vertices at equal places.
TriangleMesh Weld(const TriangleMesh& mesh) {
  TriangleMesh welded;
  std::vector<int> index;
  for (const auto& v : mesh.vertices) {
    size_t i = 0;
    while (i < welded.vertices.size() && (welded.vertices[i] - v).norm() > 1e-9) ++i;
    if (i == welded.vertices.size()) welded.vertices.push_back(v);
    index.push_back(static_cast<int>(i));
  }
  for (const auto& t : mesh.triangles) {
    welded.triangles.emplace_back(index[t[0]], index[t[1]], index[t[2]]);
  }
  return welded;
}

TEST(ManifoldRepair, LeavesAGoodMeshAlone) {
  const TriangleMesh sphere = test::MakeSphere(10, 3);
  const TriangleMesh repaired = RepairToClosedManifold(sphere);
  EXPECT_EQ(repaired.vertices.size(), sphere.vertices.size());
  EXPECT_EQ(repaired.triangles.size(), sphere.triangles.size());
  EXPECT_NEAR(SignedVolume(repaired), SignedVolume(sphere), 1e-9);
}

TEST(ManifoldRepair, TwoBoxesThatShareAnEdge) {
  const TriangleMesh touching =
      Weld(Join(test::MakeBox({0, 0, 0}, {1, 1, 1}, 1), test::MakeBox({1, 1, 0}, {2, 2, 1}, 1)));
  ASSERT_FALSE(ExamineTopology(touching).manifold);
  const TriangleMesh repaired = RepairToClosedManifold(touching);
  EXPECT_TRUE(test::IsClosedManifold(repaired));
  EXPECT_EQ(ExamineTopology(repaired).components, 2);
  EXPECT_NEAR(SignedVolume(repaired), 2, 1e-12);
}

TEST(ManifoldRepair, TwoBoxesThatShareAVertex) {
  const TriangleMesh touching =
      Weld(Join(test::MakeBox({0, 0, 0}, {1, 1, 1}, 1), test::MakeBox({1, 1, 1}, {2, 2, 2}, 1)));
  ASSERT_FALSE(ExamineTopology(touching).manifold);
  const TriangleMesh repaired = RepairToClosedManifold(touching);
  EXPECT_TRUE(test::IsClosedManifold(repaired));
  EXPECT_EQ(repaired.vertices.size(), 16u);
}

TEST(ManifoldRepair, CrumbsHollowsAndUnusedVerticesGo) {
  TriangleMesh mesh = Join(test::MakeSphere(10, 3), test::MakeSphere(1, 2, {20, 0, 0}));
  TriangleMesh hollow = test::MakeSphere(5, 2);
  for (auto& t : hollow.triangles) std::swap(t[0], t[1]);
  mesh = Join(mesh, hollow);
  mesh.vertices.emplace_back(99, 99, 99);
  const TriangleMesh repaired = RepairToClosedManifold(mesh);
  EXPECT_EQ(ExamineTopology(repaired).components, 1);
  EXPECT_EQ(repaired.vertices.size(), test::MakeSphere(10, 3).vertices.size());
}

TEST(ManifoldRepair, DuplicatesCancelAndRepeatedCornersGo) {
  TriangleMesh mesh = test::MakeSphere(10, 2);
  mesh.triangles.push_back(mesh.triangles[5]);
  mesh.triangles.emplace_back(3, 3, 7);
  const Eigen::Vector3i t(0, 40, 80);
  mesh.triangles.push_back(t);
  mesh.triangles.emplace_back(t[1], t[0], t[2]);
  const TriangleMesh repaired = RepairToClosedManifold(mesh);
  EXPECT_EQ(repaired.triangles.size(), test::MakeSphere(10, 2).triangles.size());
}

TEST(ManifoldRepair, TurnsInsideOut) {
  TriangleMesh mesh = test::MakeSphere(10, 2);
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  EXPECT_GT(SignedVolume(RepairToClosedManifold(mesh)), 0);
}

TEST(ManifoldRepair, SmallHolesAreFilled) {
  const TriangleMesh sphere = test::MakeSphere(10, 3);
  TriangleMesh holed = sphere;
  // Single triangles, a pair, a whole ring, and two holes that touch in a vertex.
  const VertexRings rings = ComputeVertexRings(sphere);
  std::vector<char> keep(sphere.triangles.size(), 1);
  keep[7] = keep[100] = keep[101] = 0;
  for (int k = rings.offsets[300]; k < rings.offsets[301]; ++k) keep[rings.triangles[k]] = 0;
  keep[rings.triangles[rings.offsets[500]]] = keep[rings.triangles[rings.offsets[500] + 3]] = 0;
  holed = SelectTriangles(sphere, keep);
  ASSERT_GT(ExamineTopology(holed).boundary_edges, 15);
  const TriangleMesh repaired = RepairToClosedManifold(holed);
  EXPECT_TRUE(test::IsClosedManifold(repaired));
  EXPECT_NEAR(SignedVolume(repaired), SignedVolume(sphere), 0.003 * SignedVolume(sphere));
}

TEST(ManifoldRepair, LargeHolesAndFlatSheetsAreErrors) {
  TriangleMesh open = test::MakeSphere(10, 4);
  std::erase_if(open.triangles,
                [&](const Eigen::Vector3i& t) { return open.vertices[t[0]].z() > 4; });
  EXPECT_NE(test::ErrorOf([&] { RepairToClosedManifold(open); }).find("hole"), std::string::npos);
  EXPECT_NE(test::ErrorOf([] { RepairToClosedManifold({}); }), "");
  TriangleMesh sheet = test::MakeSquare(10, 0, 2);
  const size_t count = sheet.triangles.size();
  for (size_t i = 0; i < count; ++i) {
    const auto t = sheet.triangles[i];
    sheet.triangles.emplace_back(t[1], t[0], t[2]);
  }
  EXPECT_NE(test::ErrorOf([&] { RepairToClosedManifold(sheet); }), "");
}

TEST(ManifoldRepair, SelectTrianglesKeepsData) {
  TriangleMesh mesh = test::MakeSquare(2, 0, 1);
  mesh.confidence = {0.1f, 0.2f, 0.3f, 0.4f};
  mesh.normals.assign(4, {0, 0, 1});
  const TriangleMesh one = SelectTriangles(mesh, {0, 1});
  ASSERT_EQ(one.vertices.size(), 3u);
  EXPECT_EQ(one.confidence.size(), 3u);
  for (int k = 0; k < 3; ++k) {
    const int old_index = mesh.triangles[1][k], new_index = one.triangles[0][k];
    EXPECT_EQ(one.vertices[new_index], mesh.vertices[old_index]);
    EXPECT_EQ(one.confidence[new_index], mesh.confidence[old_index]);
  }
}

}  // namespace
}  // namespace lfm
