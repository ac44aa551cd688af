// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/surface_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

using test::ErrorOf;

TEST(SurfaceDistance, SummaryOfKnownNumbers) {
  std::vector<double> distances;
  for (int i = 100; i >= 0; --i) distances.push_back(i);
  const DistanceStatistics s = SummarizeDistances(distances);
  EXPECT_EQ(s.samples, 101);
  EXPECT_DOUBLE_EQ(s.mean, 50);
  EXPECT_DOUBLE_EQ(s.median, 50);
  EXPECT_DOUBLE_EQ(s.p95, 95);
  EXPECT_DOUBLE_EQ(s.max, 100);
  EXPECT_NEAR(s.rms, std::sqrt(100 * 201 / 6.0), 1e-12);
}

TEST(SurfaceDistance, SummaryOfNoneAndOne) {
  EXPECT_EQ(SummarizeDistances({}).samples, 0);
  EXPECT_EQ(SummarizeDistances({}).p95, 0);
  const DistanceStatistics one = SummarizeDistances({3});
  EXPECT_EQ(one.mean, 3);
  EXPECT_EQ(one.median, 3);
  EXPECT_EQ(one.p95, 3);
}

TEST(SurfaceDistance, SummaryRefusesNonsense) {
  EXPECT_NE(ErrorOf([] { SummarizeDistances({1, std::nan("")}); }), "");
  EXPECT_NE(ErrorOf([] { SummarizeDistances({-1}); }), "");
}

TEST(SurfaceDistance, PointAboveAPlane) {
  const TriangleMesh square = test::MakeSquare(100, 0, 10);
  const auto distances = DistancesToMesh({{1, 2, 5}, {-3, 4, -0.25}, {53, 0, 4}}, square);
  EXPECT_NEAR(distances[0], 5, 1e-4);
  EXPECT_NEAR(distances[1], 0.25, 1e-4);
  EXPECT_NEAR(distances[2], 5, 1e-4);
}

TEST(SurfaceDistance, SphereInSphere) {
  const TriangleMesh inner = test::MakeSphere(30, 6), outer = test::MakeSphere(32, 6);
  const auto out = SummarizeDistances(DistancesToMesh(SampleSurface(inner, 5000, 1).points, outer));
  const auto in = SummarizeDistances(DistancesToMesh(SampleSurface(outer, 5000, 2).points, inner));
  // A triangle of edge 0.5 mm dips L^2 / 6 R = 0.002 mm below the sphere.
  constexpr double kFacet_abs = 0.004;
  for (const auto& s : {out, in}) {
    EXPECT_NEAR(s.mean, 2, kFacet_abs);
    EXPECT_NEAR(s.max, 2, kFacet_abs);
    EXPECT_EQ(s.samples, 5000);
  }
}

TEST(SurfaceDistance, SamplesLieOnTheirTriangles) {
  const TriangleMesh torus = test::MakeTorus(30, 10, 10, 40, 20);
  const SurfaceSamples samples = SampleSurface(torus, 3000, 5);
  ASSERT_EQ(samples.points.size(), 3000u);
  for (size_t i = 0; i < samples.points.size(); ++i) {
    const Eigen::Vector3i& t = torus.triangles[samples.triangles[i]];
    EXPECT_NEAR(samples.normals[i].norm(), 1, 1e-12);
    EXPECT_NEAR(samples.normals[i].dot(samples.points[i] - torus.vertices[t[0]]), 0, 1e-9);
  }
  for (const double d : DistancesToMesh(samples.points, torus)) EXPECT_LT(d, 1e-4);
}

// Chi-square over the triangles of a mesh whose areas differ a hundredfold, and over cells inside
// one triangle. Systematic sampling has less scatter than independent one, so only too much scatter
// would show a fault between triangles; inside a triangle samples are independent.
TEST(SurfaceDistance, SamplingIsUniformByArea) {
  TriangleMesh fan;
  fan.vertices.emplace_back(0, 0, 0);
  const int n = 40;
  for (int i = 0; i <= n; ++i) fan.vertices.emplace_back(0.0025 * i * i, 1, 0);
  for (int i = 0; i < n; ++i) fan.triangles.emplace_back(0, i + 2, i + 1);
  const int64_t count = 40000;
  const SurfaceSamples samples = SampleSurface(fan, count, 11);
  std::vector<double> hits(n, 0);
  for (const int t : samples.triangles) hits[t] += 1;
  const double total = test::TotalArea(fan);
  double chi_square = 0;
  for (int t = 0; t < n; ++t) {
    const double expected = static_cast<double>(count) * TriangleArea(fan, t) / total;
    chi_square += (hits[t] - expected) * (hits[t] - expected) / expected;
  }
  EXPECT_LT(chi_square, 66);  // 39 degrees of freedom, 99.5 %
}

TEST(SurfaceDistance, SamplingIsUniformInsideATriangle) {
  TriangleMesh one;
  one.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  one.triangles = {{0, 1, 2}};
  const int64_t count = 64000;
  const int cells = 8;  // 64 triangles of equal area
  std::vector<double> hits(cells * cells * 2, 0);
  for (const Eigen::Vector3d& p : SampleSurface(one, count, 3).points) {
    const int x = std::min(cells - 1, static_cast<int>(p.x() * cells));
    const int y = std::min(cells - 1, static_cast<int>(p.y() * cells));
    const bool upper = p.x() * cells - x + p.y() * cells - y > 1;
    hits[2 * (y * cells + x) + upper] += 1;
  }
  double chi_square = 0;
  const double expected = static_cast<double>(count) / (cells * cells);
  for (int y = 0; y < cells; ++y) {
    for (int x = 0; x + y < cells; ++x) {
      for (int upper = 0; upper < (x + y < cells - 1 ? 2 : 1); ++upper) {
        const double off = hits[2 * (y * cells + x) + upper] - expected;
        chi_square += off * off / expected;
      }
    }
  }
  EXPECT_LT(chi_square, 96);  // 63 degrees of freedom, 99.5 %
  EXPECT_GT(chi_square, 37);  // 0.5 %
}

TEST(SurfaceDistance, SamplesDoNotDependOnThreads) {
  const TriangleMesh sphere = test::MakeSphere(30, 3);
  SetThreadCount(1);
  const SurfaceSamples one = SampleSurface(sphere, 5000, 9);
  SetThreadCount(3);
  const SurfaceSamples three = SampleSurface(sphere, 5000, 9);
  SetThreadCount(0);
  EXPECT_TRUE(one.points == three.points);
  EXPECT_FALSE(one.points == SampleSurface(sphere, 5000, 10).points);
}

TEST(SurfaceDistance, Extremes) {
  const TriangleMesh sphere = test::MakeSphere(30, 1);
  EXPECT_TRUE(SampleSurface(sphere, 0, 1).points.empty());
  EXPECT_TRUE(SampleSurface(sphere, -5, 1).points.empty());
  EXPECT_EQ(SampleSurface(sphere, 1, 1).points.size(), 1u);
  EXPECT_TRUE(DistancesToMesh({}, sphere).empty());

  TriangleMesh flat;
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  flat.triangles = {{0, 1, 2}};
  EXPECT_NE(ErrorOf([&] { SampleSurface(flat, 10, 1); }), "");
  EXPECT_NE(ErrorOf([&] { SampleSurface({}, 10, 1); }), "");
  EXPECT_NE(ErrorOf([&] { DistancesToMesh({{0, 0, 0}}, {}); }), "");
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_NE(ErrorOf([&] { DistancesToMesh({{0, infinite, 0}}, sphere); }), "");
}

TEST(SurfaceDistance, NoSamplesOnTrianglesWithoutArea) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 2, 1}};
  for (const int t : SampleSurface(mesh, 1000, 1).triangles) EXPECT_EQ(t, 1);
}

TEST(SurfaceDistance, FarFromTheOrigin) {
  const Eigen::Vector3d far(1e6, -2e6, 3e6);
  const TriangleMesh sphere = test::MakeSphere(30, 4, far);
  const auto distances = DistancesToMesh({far + Eigen::Vector3d(35, 0, 0)}, sphere);
  EXPECT_NEAR(distances[0], 5, 0.1);
}

}  // namespace
}  // namespace lfm
