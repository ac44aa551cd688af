// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/decimation_target.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

TEST(DecimationTarget, CountIsHit) {
  const TriangleMesh surface = test::MakeTorus(30, 10, 10, 160, 60);
  for (const int64_t count : {3000, 600}) {
    const DecimatedMesh result = DecimateToCount(surface, count);
    EXPECT_NEAR(static_cast<double>(result.mesh.triangles.size()), static_cast<double>(count),
                0.02 * static_cast<double>(count));
    EXPECT_TRUE(test::IsClosedManifold(result.mesh));
    EXPECT_EQ(ExamineTopology(result.mesh).degenerate_triangles, 0);
    EXPECT_GT(test::SmallestAngles(result.mesh).front(), 8);
  }
}

TEST(DecimationTarget, ToleranceIsHeldAndNoCoarserMeshHoldsIt) {
  const TriangleMesh surface = test::MakeTorus(30, 10, 10, 140, 56);
  const double tolerance = 0.15;
  const DecimatedMesh best = DecimateToTolerance(surface, tolerance, SilentProgress());
  EXPECT_LE(best.deviation.WorseP95(), tolerance);
  EXPECT_TRUE(test::IsClosedManifold(best.mesh));
  // Independently sampled, the figure is the same to a few per cent.
  const auto check =
      SummarizeDistances(DistancesToMesh(SampleSurface(surface, 30000, 77).points, best.mesh));
  EXPECT_LE(check.p95, 1.04 * tolerance);
  const auto count = static_cast<double>(best.mesh.triangles.size());
  EXPECT_LT(count, 0.25 * static_cast<double>(surface.triangles.size()));
  const DecimatedMesh coarser = DecimateToCount(surface, std::llround(0.88 * count));
  EXPECT_GT(coarser.deviation.WorseP95(), tolerance);
}

TEST(DecimationTarget, TighterToleranceNeedsMoreTriangles) {
  const TriangleMesh surface = test::MakeSphere(30, 4, {0, 0, 30});
  size_t fewer = 0;
  for (const double tolerance : {1.0, 0.3, 0.1}) {
    const auto result = DecimateToTolerance(surface, tolerance, SilentProgress());
    EXPECT_LE(result.deviation.WorseP95(), tolerance);
    EXPECT_GT(result.mesh.triangles.size(), fewer);
    fewer = result.mesh.triangles.size();
  }
  // On a sphere the best facets of area A lie within their sagitta, L^2 / 8 R and less.
  const double edge = std::sqrt(4 / std::sqrt(3.0) * 4 * M_PI * 900 / static_cast<double>(fewer));
  EXPECT_GT(edge * edge / (8 * 30), 0.1);
}

TEST(DecimationTarget, SurfaceItselfWhereNothingMayGo) {
  const TriangleMesh surface = test::MakeSphere(30, 2);
  const auto exact = DecimateToTolerance(surface, 1e-9, SilentProgress());
  EXPECT_EQ(exact.mesh.triangles.size(), surface.triangles.size());
  EXPECT_EQ(DecimateToCount(surface, 1000000).mesh.triangles.size(), surface.triangles.size());
  EXPECT_LT(DecimateToCount(surface, 1000000).deviation.both.max, 1e-3);
}

TEST(DecimationTarget, HugeToleranceEndsSomewhere) {
  const auto result = DecimateToTolerance(test::MakeSphere(30, 3), 1e6, SilentProgress());
  EXPECT_TRUE(test::IsClosedManifold(result.mesh));
  EXPECT_LE(result.mesh.triangles.size(), 20u);
}

TEST(DecimationTarget, DeviationOfConcentricSpheres) {
  const auto deviation = MeasureDeviation(test::MakeSphere(29, 5), test::MakeSphere(30, 5));
  EXPECT_NEAR(deviation.both.mean, 1, 0.01);
  EXPECT_NEAR(deviation.WorseP95(), 1, 0.01);
  EXPECT_EQ(deviation.both.samples, deviation.from_mesh.samples + deviation.from_surface.samples);
}

TEST(DecimationTarget, DeviationSeesBothDirections) {
  // A sphere alone lies on a pair of spheres; the pair does not lie on it.
  TriangleMesh one = test::MakeSphere(10, 4), pair = one;
  const TriangleMesh other = test::MakeSphere(10, 4, {50, 0, 0});
  const Eigen::Vector3i offset = Eigen::Vector3i::Constant(static_cast<int>(pair.vertices.size()));
  for (const auto& v : other.vertices) pair.vertices.push_back(v);
  for (const auto& t : other.triangles) pair.triangles.push_back(t + offset);
  const auto deviation = MeasureDeviation(one, pair);
  EXPECT_LT(deviation.from_mesh.p95, 1e-3);
  EXPECT_GT(deviation.from_surface.p95, 30);
  EXPECT_GT(deviation.WorseP95(), 30);
}

TEST(DecimationTarget, AMeanNeverCostsTheShape) {
  const TriangleMesh surface = test::MakeSphere(30, 5);
  const double area = TotalArea(surface);
  const auto area_of_triangle = [](const TriangleMesh& mesh) {
    return TotalArea(mesh) / static_cast<double>(mesh.triangles.size());
  };
  const auto nearest_to = [&](double triangles) {
    return DecimateToMean(surface, 30, area / triangles, area_of_triangle, SilentProgress()).mesh;
  };
  EXPECT_NEAR(static_cast<double>(nearest_to(900).triangles.size()), 900, 30);
  // So few triangles cannot show a ball.
  EXPECT_LT(TotalArea(DecimateToCount(surface, 16).mesh), 0.9 * area);
  const TriangleMesh few = nearest_to(4);
  EXPECT_GT(TotalArea(few), 0.9 * area);
  EXPECT_LT(few.triangles.size(), 100u);
}

}  // namespace
}  // namespace lfm
