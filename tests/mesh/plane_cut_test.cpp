// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/plane_cut.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

double CapArea(const TriangleMesh& mesh) {
  double area = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const int index = static_cast<int>(t);
    bool flat = true;
    for (int k = 0; k < 3; ++k) flat &= mesh.vertices[mesh.triangles[t][k]].z() == 0;
    if (!flat) continue;
    EXPECT_LT(TriangleNormal(mesh, index).z(), -0.999);
    area += TriangleArea(mesh, index);
  }
  return area;
}

TEST(PlaneCut, SphereCutInTheMiddleIsAClosedHalfSphere) {
  const TriangleMesh half = CutAtPlatform(test::MakeSphere(20, 5), 1);
  EXPECT_TRUE(test::IsClosedManifold(half));
  EXPECT_EQ(ExamineTopology(half).degenerate_triangles, 0);
  for (const auto& v : half.vertices) EXPECT_GE(v.z(), 0);
  EXPECT_NEAR(SignedVolume(half), 2.0 / 3 * M_PI * 8000, 0.01 * 2.0 / 3 * M_PI * 8000);
  EXPECT_NEAR(CapArea(half), M_PI * 400, 0.01 * M_PI * 400);
  EXPECT_GT(test::SmallestAngles(half).front(), 1.0);
}

TEST(PlaneCut, VerticesInThePlaneAreNoTrouble) {
  const TriangleMesh box = test::MakeBox({-5, -5, -5}, {5, 5, 5}, 10);
  const TriangleMesh half = CutAtPlatform(box, 0.5);
  EXPECT_TRUE(test::IsClosedManifold(half));
  EXPECT_NEAR(SignedVolume(half), 500, 1e-6);
}

TEST(PlaneCut, TorusOnEdgeGivesTwoFeet) {
  TriangleMesh torus = test::MakeTorus(20, 5, 0, 80, 40);
  for (auto& v : torus.vertices) v = {v.x(), -v.z(), v.y() + 10};
  const TriangleMesh cut = CutAtPlatform(torus, 0.8);
  EXPECT_TRUE(test::IsClosedManifold(cut));
  EXPECT_EQ(ExamineTopology(cut).components, 1);
  EXPECT_GT(CapArea(cut), M_PI * 25);  // two ellipses
}

TEST(PlaneCut, LyingTorusKeepsItsHole) {
  const TriangleMesh cut = CutAtPlatform(test::MakeTorus(20, 8, 3, 100, 50), 0.8);
  EXPECT_TRUE(test::IsClosedManifold(cut));
  const double half_width = std::sqrt(64.0 - 9);
  const double annulus = M_PI * (std::pow(20 + half_width, 2) - std::pow(20 - half_width, 2));
  EXPECT_NEAR(CapArea(cut), annulus, 0.02 * annulus);
  const auto euler =
      static_cast<int64_t>(cut.vertices.size()) - static_cast<int64_t>(cut.triangles.size()) / 2;
  EXPECT_EQ(euler, 0);
}

TEST(PlaneCut, AboveAndBelow) {
  const TriangleMesh above = test::MakeSphere(5, 2, {0, 0, 10});
  EXPECT_TRUE(CutAtPlatform(above, 0.5).vertices == above.vertices);
  EXPECT_TRUE(CutAtPlatform(test::MakeSphere(5, 2, {0, 0, -10}), 0.5).triangles.empty());
}

TEST(PlaneCut, OpenMeshIsAnError) {
  TriangleMesh sphere = test::MakeSphere(20, 3);
  const auto crosses =
      std::find_if(sphere.triangles.begin(), sphere.triangles.end(), [&](const Eigen::Vector3i& t) {
        const double a = sphere.vertices[t[0]].z(), b = sphere.vertices[t[1]].z(),
                     c = sphere.vertices[t[2]].z();
        return std::min({a, b, c}) < -0.5 && std::max({a, b, c}) > 0.5;
      });
  ASSERT_NE(crosses, sphere.triangles.end());
  sphere.triangles.erase(crosses);
  EXPECT_NE(test::ErrorOf([&] { CutAtPlatform(sphere, 0.5); }), "");
}

}  // namespace
}  // namespace lfm
