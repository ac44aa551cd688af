// SPDX-License-Identifier: BSD-3-Clause
#include "fields/light_triangulation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "core/error.h"
#include "tests/fields/light_directions.h"

namespace lfm {
namespace {

using Eigen::Vector3d;

Vector3d RandomDirection(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random), y = normal(random), z = normal(random);
  return Vector3d(x, y, z).normalized();
}

std::vector<double> Dense(const LightShares& shares, size_t count) {
  std::vector<double> dense(count);
  for (int k = 0; k < 3; ++k) dense[shares.light[k]] += shares.share[k];
  return dense;
}

void ExpectExactAtTheLights(const std::vector<Vector3d>& directions) {
  const LightTriangulation lights = TriangulateLights(directions);
  for (size_t i = 0; i < directions.size(); ++i) {
    Vector3d met = Vector3d::Zero();
    const std::vector<double> shares =
        Dense(InterpolateLights(lights, 3 * directions[i]), directions.size());
    double sum = 0;
    for (size_t k = 0; k < shares.size(); ++k) {
      EXPECT_GE(shares[k], 0);
      sum += shares[k];
      if (shares[k] > 1e-9) met += shares[k] * directions[k];
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    EXPECT_LT((met - directions[i]).norm(), 1e-6) << i;
  }
}

TEST(LightTriangulation, AFullSphereHasEulersNumberOfTriangles) {
  const LightTriangulation lights = TriangulateLights(Spiral(200, -1));
  EXPECT_TRUE(lights.Surrounds());
  EXPECT_EQ(lights.triangles.size(), 2 * 200u - 4);
}

TEST(LightTriangulation, IsDelaunay) {
  const LightTriangulation lights = TriangulateLights(Spiral(60, -0.2));
  ASSERT_FALSE(lights.triangles.empty());
  for (const Eigen::Vector3i& t : lights.triangles) {
    const Vector3d a = lights.directions[t[0]];
    const Vector3d normal =
        (lights.directions[t[1]] - a).cross(lights.directions[t[2]] - a).normalized();
    EXPECT_GT(normal.dot(a), 0);
    for (const Vector3d& d : lights.directions) EXPECT_LE(normal.dot(d - a), 1e-9);
  }
}

TEST(LightTriangulation, LeavesTheGapOfADomeOpen) {
  for (const double lowest : {0.3, 0.0, -0.1, -0.3}) {
    const LightTriangulation lights = TriangulateLights(Spiral(150, lowest));
    EXPECT_FALSE(lights.Surrounds()) << lowest;
    // No triangle looks down where there is no light.
    for (const Eigen::Vector3i& t : lights.triangles) {
      const Vector3d middle =
          lights.directions[t[0]] + lights.directions[t[1]] + lights.directions[t[2]];
      EXPECT_GT(middle.normalized().z(), lowest - 0.1);
    }
    // The rim is one closed line: as many edges as lights on it, each on two of them.
    std::map<int, int> edges;
    for (const Eigen::Vector2i& edge : lights.rim) ++edges[edge[0]], ++edges[edge[1]];
    for (const auto& [light, count] : edges) EXPECT_EQ(count, 2) << light;
    EXPECT_EQ(lights.triangles.size(), 2 * 150 - 2 - lights.rim.size());
  }
}

TEST(LightTriangulation, SharesAreBarycentric) {
  const std::vector<Vector3d> axes = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1},
                                      {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  const LightTriangulation lights = TriangulateLights(axes);
  EXPECT_TRUE(lights.Surrounds());
  const std::vector<double> shares = Dense(InterpolateLights(lights, {1, 2, -5}), 6);
  const double expected[] = {1 / 8.0, 2 / 8.0, 0, 0, 0, 5 / 8.0};
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(shares[i], expected[i], 1e-12) << i;
}

TEST(LightTriangulation, IsExactAtTheLights) {
  ExpectExactAtTheLights(Spiral(100, -1));
  ExpectExactAtTheLights(Spiral(100, 0.1));
  ExpectExactAtTheLights(Spiral(4, -1));
  ExpectExactAtTheLights(Spiral(3, 0.2));
  ExpectExactAtTheLights(Spiral(2, 0.2));
  ExpectExactAtTheLights(Spiral(1, 0.2));
  ExpectExactAtTheLights({{0, 0, 1}, {0, 0, -1}});
  ExpectExactAtTheLights({{0, 0, 1}, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}});  // some twice
  std::vector<Vector3d> circle, great_circle, cube;
  for (int i = 0; i < 12; ++i) {
    const double angle = i * std::numbers::pi / 6;
    circle.push_back(Vector3d(std::cos(angle), std::sin(angle), 0.5).normalized());
    great_circle.emplace_back(std::cos(angle), std::sin(angle), 0);
  }
  for (int i = 0; i < 8; ++i) {
    cube.push_back(Vector3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1).normalized());
  }
  ExpectExactAtTheLights(circle);
  ExpectExactAtTheLights(great_circle);
  ExpectExactAtTheLights(cube);
  EXPECT_TRUE(TriangulateLights(cube).Surrounds());
  EXPECT_TRUE(TriangulateLights(great_circle).triangles.empty());
  EXPECT_EQ(TriangulateLights(great_circle).rim.size(), 12u);
}

TEST(LightTriangulation, MovesContinuously) {
  // Shares times directions follow the direction; a jump would show as a step that no Lipschitz
  // constant of this spacing allows.
  constexpr double kStep = 1e-4, kMostRise = 50;
  for (const double lowest : {-1.0, 0.0}) {
    const std::vector<Vector3d> directions = Spiral(80, lowest);
    const LightTriangulation lights = TriangulateLights(directions);
    std::mt19937 random(5);
    for (int i = 0; i < 2000; ++i) {
      Vector3d d = RandomDirection(random);
      if (d.z() < lowest - 0.2) continue;  // far outside, where it may jump
      const Vector3d moved = d + kStep * RandomDirection(random);
      const std::vector<double> a = Dense(InterpolateLights(lights, d), 80);
      const std::vector<double> b = Dense(InterpolateLights(lights, moved), 80);
      for (int k = 0; k < 80; ++k) EXPECT_LT(std::abs(a[k] - b[k]), kMostRise * kStep);
    }
  }
}

TEST(LightTriangulation, OutsideTakesTheNearestPointOfTheRim) {
  const LightTriangulation lights = TriangulateLights(Spiral(150, 0.1));
  std::mt19937 random(8);
  for (int i = 0; i < 200; ++i) {
    Vector3d d = RandomDirection(random);
    d.z() = -std::abs(d.z());
    const std::vector<double> shares = Dense(InterpolateLights(lights, d), 150);
    Vector3d met = Vector3d::Zero();
    double nearest = -1;
    for (int k = 0; k < 150; ++k) {
      met += shares[k] * lights.directions[k];
      nearest = std::max(nearest, lights.directions[k].dot(d));
    }
    EXPECT_GE(met.normalized().dot(d), nearest - 1e-12);
  }
}

TEST(LightTriangulation, RefusesWhatIsNoDirection) {
  EXPECT_THROW(TriangulateLights({}), Error);
  EXPECT_THROW(TriangulateLights({{0, 0, 2}}), Error);
  EXPECT_THROW(TriangulateLights({{0, 0, std::nan("")}}), Error);
}

}  // namespace
}  // namespace lfm
