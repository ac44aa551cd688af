// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/surface_comparison.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

TEST(SurfaceComparison, SharesAndTheirHarmonicMean) {
  const SurfaceComparison c = CompareDistances({0.1, 0.1, 0.3, 0.1}, {0.1, 0.5}, 0.2);
  EXPECT_DOUBLE_EQ(c.accuracy, 0.75);
  EXPECT_DOUBLE_EQ(c.completeness, 0.5);
  EXPECT_DOUBLE_EQ(c.f_score, 0.6);
  EXPECT_NEAR(c.from_mesh.mean, 0.15, 1e-12);
  EXPECT_NEAR(c.both.mean, 0.2, 1e-12);
  EXPECT_EQ(c.both.max, 0.5);
  EXPECT_EQ(c.both.samples, 6);
}

TEST(SurfaceComparison, ConcentricSpheres) {
  const TriangleMesh ball = test::MakeSphere(30, 5), larger = test::MakeSphere(30.25, 5);
  const SurfaceComparison near = CompareSurfaces(larger, ball, 0.3, 20000);
  EXPECT_NEAR(near.both.mean, 0.25, 0.02);
  EXPECT_EQ(near.f_score, 1);
  EXPECT_EQ(CompareSurfaces(larger, ball, 0.2, 20000).f_score, 0);
  // Half of the ball is accurate, and complete by half.
  TriangleMesh half = ball;
  std::erase_if(half.triangles, [&](const Eigen::Vector3i& t) {
    return ball.vertices[t[0]].z() + ball.vertices[t[1]].z() + ball.vertices[t[2]].z() < 0;
  });
  const SurfaceComparison c = CompareSurfaces(half, ball, 0.2, 20000);
  EXPECT_EQ(c.accuracy, 1);
  EXPECT_NEAR(c.completeness, 0.5, 0.03);
  EXPECT_NEAR(c.f_score, 2.0 / 3, 0.03);
}

TEST(SurfaceComparison, ExtremesAreNamed) {
  EXPECT_EQ(CompareDistances({}, {}, 1).f_score, 0);
  EXPECT_EQ(CompareDistances({5}, {5}, 1).f_score, 0);
  EXPECT_THROW(CompareDistances({1}, {1}, 0), Error);
  EXPECT_THROW(CompareDistances({-1}, {1}, 1), Error);
  EXPECT_THROW(CompareDistances({1}, {std::numeric_limits<double>::quiet_NaN()}, 1), Error);
  EXPECT_THROW(CompareSurfaces({}, test::MakeSphere(1, 1), 1), Error);
}

TEST(SurfaceComparison, ReferencesOfNoUseAreNamed) {
  const auto message = [](const TriangleMesh& mesh) {
    return test::ErrorOf([&] { ValidateReference(mesh, "dir/truth.ply"); });
  };
  const TriangleMesh ball = test::MakeSphere(30, 2, {10000, -10000, 0});
  EXPECT_EQ(message(ball), "");
  TriangleMesh bad = ball;
  bad.vertices[7].y() = -1e38;
  EXPECT_EQ(message(bad).find("dir/truth.ply: vertex 7 has a coordinate of 1e+38 mm"), 0u);
  bad = ball;
  bad.vertices[7].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message(bad).find("dir/truth.ply: "), 0u);
  bad = ball;
  bad.triangles[3][2] = 1 << 20;
  EXPECT_EQ(message(bad).find("dir/truth.ply: "), 0u);
  bad = ball;
  for (Eigen::Vector3d& v : bad.vertices) v = {v.x(), 0, 0};
  EXPECT_EQ(message(bad).find("dir/truth.ply: its triangles have no area"), 0u);
}

TEST(SurfaceComparison, JsonHoldsEveryFigure) {
  const nlohmann::json json = ComparisonToJson(CompareDistances({0.1}, {0.3}, 0.2));
  EXPECT_DOUBLE_EQ(json.at("accuracy"), 1);
  EXPECT_DOUBLE_EQ(json.at("completeness"), 0);
  EXPECT_DOUBLE_EQ(json.at("both").at("max_mm"), 0.3);
  EXPECT_DOUBLE_EQ(json.at("from_surface").at("mean_mm"), 0.1);
}

}  // namespace
}  // namespace lfm
