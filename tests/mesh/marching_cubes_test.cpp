// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/marching_cubes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include "core/half_edges.h"
#include "mesh/manifold_repair.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

TriangleMesh March(int n, const std::function<double(const Eigen::Vector3d&)>& f) {
  return MarchCubes(n, [&](int k) {
    std::vector<float> layer;
    for (int y = 0; y <= n; ++y) {
      for (int x = 0; x <= n; ++x) layer.push_back(static_cast<float>(f(Eigen::Vector3d(x, y, k))));
    }
    return layer;
  });
}

TEST(MarchCubes, SphereIsClosedOutwardsAndExact) {
  const Eigen::Vector3d center(15.2, 16.1, 15.7);
  const TriangleMesh mesh =
      March(32, [&](const Eigen::Vector3d& p) { return 10 - (p - center).norm(); });
  EXPECT_TRUE(test::IsClosedManifold(mesh));
  EXPECT_EQ(ExamineTopology(mesh).components, 1);
  EXPECT_EQ(mesh.vertices.size(), mesh.triangles.size() / 2 + 2);
  // Inscribed, so smaller; no facet is wider than a cell's diagonal, and none lies deeper than the
  // sagitta of that chord, 3 / (8 * 10).
  const double ball = 4.0 / 3 * std::numbers::pi * 1000;
  EXPECT_LT(SignedVolume(mesh), ball);
  EXPECT_GT(SignedVolume(mesh), (1 - 3 * 0.0375 / 10) * ball);
  for (const Eigen::Vector3d& v : mesh.vertices) EXPECT_NEAR((v - center).norm(), 10, 2e-3);
}

// Every pattern of corners occurs, ambiguous faces too: each edge has as many triangles one way as
// the other.
TEST(MarchCubes, NoiseHasNoHoles) {
  constexpr int kCells = 14;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const TriangleMesh mesh = March(kCells, [&](const Eigen::Vector3d& p) {
    const bool wall = p.minCoeff() == 0 || p.maxCoeff() == kCells;
    const double value = normal(random);
    return wall ? -std::abs(value) - 0.1 : value;
  });
  EXPECT_GT(mesh.triangles.size(), 3000u);
  const std::vector<HalfEdge> edges = SortedHalfEdges(mesh);
  for (size_t i = 0; i < edges.size();) {
    int balance = 0;
    size_t j = i;
    for (; j < edges.size() && SameEdge(edges[i], edges[j]); ++j) {
      balance += edges[j].Forward() ? 1 : -1;
    }
    ASSERT_EQ(balance, 0);
    i = j;
  }
  EXPECT_TRUE(test::IsClosedManifold(RepairToClosedManifold(mesh)));
}

TEST(MarchCubes, ExtremesGiveNothingOrStayFinite) {
  EXPECT_TRUE(March(4, [](const Eigen::Vector3d&) { return 1; }).triangles.empty());
  EXPECT_TRUE(March(4, [](const Eigen::Vector3d&) { return -1; }).triangles.empty());
  EXPECT_TRUE(March(4, [](const Eigen::Vector3d&) {
                return std::numeric_limits<double>::quiet_NaN();
              }).triangles.empty());
  EXPECT_TRUE(MarchCubes(0, [](int) { return std::vector<float>(1, 1); }).triangles.empty());
  // One corner that holds a huge value, one that holds the least above zero.
  for (const double value : {1e30, 1e-38}) {
    const TriangleMesh mesh = March(
        4, [&](const Eigen::Vector3d& p) { return p == Eigen::Vector3d(2, 2, 2) ? value : -1.0; });
    EXPECT_TRUE(test::IsClosedManifold(mesh));
    EXPECT_EQ(mesh.triangles.size(), 8u);
    for (const Eigen::Vector3d& v : mesh.vertices) EXPECT_TRUE(v.allFinite());
  }
}

}  // namespace
}  // namespace lfm
