// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/error_bound.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/error.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

bool Within(const TriangleMesh& a, const TriangleMesh& b, double max_mm) {
  return IsWithin(a, b, RayScene(b), max_mm);
}

// The farthest point of a facet from its sphere is its middle: closed form over all facets.
double Sagitta(const TriangleMesh& mesh, double radius) {
  double largest = 0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d normal = (mesh.vertices[t[1]] - mesh.vertices[t[0]])
                                       .cross(mesh.vertices[t[2]] - mesh.vertices[t[0]])
                                       .normalized();
    largest = std::max(largest, radius - normal.dot(mesh.vertices[t[0]]));
  }
  return largest;
}

TEST(ErrorBound, IsTightOnASphere) {
  const TriangleMesh coarse = test::MakeSphere(30, 2), fine = test::MakeSphere(30, 5);
  const double off = Sagitta(coarse, 30), spare = Sagitta(fine, 30);
  EXPECT_TRUE(Within(coarse, fine, off + spare));
  EXPECT_FALSE(Within(coarse, fine, off - 2 * spare));
  EXPECT_TRUE(Within(fine, coarse, 1.05 * off));
  EXPECT_FALSE(Within(fine, coarse, 0.9 * off));
}

// A spike so thin that samples by area miss it.
TEST(ErrorBound, ASpikeIsNotMissed) {
  const TriangleMesh ball = test::MakeSphere(30, 3);
  TriangleMesh spiked = ball;
  spiked.vertices[100] *= 1.1;
  EXPECT_TRUE(Within(ball, ball, 1e-6));
  EXPECT_FALSE(Within(spiked, ball, 2.5));
  EXPECT_TRUE(Within(spiked, ball, 3.01));
}

TEST(ErrorBound, ConcentricSpheresBothWays) {
  const TriangleMesh inner = test::MakeSphere(30, 4), outer = test::MakeSphere(31, 4);
  EXPECT_TRUE(Within(inner, outer, 1.01));
  EXPECT_TRUE(Within(outer, inner, 1.03));
  EXPECT_FALSE(Within(inner, outer, 0.98));
  EXPECT_FALSE(Within(outer, inner, 0.98));
  EXPECT_THROW(Within({}, inner, 1), Error);
}

TEST(ErrorBound, DistanceToTriangleIsTheLeastOverThePlane) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  const auto point = [&] {
    return Eigen::Vector3d(normal(random), normal(random), normal(random));
  };
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector3d a = point(), b = point(), c = point(), p = 2 * point();
    double least = 1e9;
    constexpr int kSteps = 120;
    for (int u = 0; u <= kSteps; ++u) {
      for (int v = 0; u + v <= kSteps; ++v) {
        least = std::min(least, (a + (b - a) * u / kSteps + (c - a) * v / kSteps - p).norm());
      }
    }
    const double distance = DistanceToTriangle(p, a, b, c);
    EXPECT_LE(distance, least + 1e-12);
    EXPECT_GT(distance, least - 0.05);
  }
  const Eigen::Vector3d o(0, 0, 0), x(1, 0, 0);
  EXPECT_NEAR(DistanceToTriangle({0.5, 2, 0}, o, x, x), 2, 1e-12);  // a needle
  EXPECT_NEAR(DistanceToTriangle({0, 3, 4}, o, o, o), 5, 1e-12);    // a point
}

}  // namespace
}  // namespace lfm
