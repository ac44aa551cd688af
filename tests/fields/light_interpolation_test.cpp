// SPDX-License-Identifier: BSD-3-Clause
#include "fields/light_interpolation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/error.h"

namespace lfm {
namespace {

std::vector<Eigen::Vector3d> Dome(int count) {
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (i + 0.5) / count, r = std::sqrt(1 - z * z);
    directions.emplace_back(r * std::cos(2.4 * i), r * std::sin(2.4 * i), z);
  }
  return directions;
}

// What the weights make of the directions themselves.
Eigen::Vector3d Mixed(const std::vector<Eigen::Vector3d>& lights, const LightWeights& weights) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& [light, weight] : weights) sum += weight * lights[light];
  return sum;
}

TEST(LightInterpolation, PassesThroughTheDirectionWithinTheDome) {
  const std::vector<Eigen::Vector3d> lights = Dome(100);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 300; ++i) {
    Eigen::Vector3d d(normal(random), normal(random), std::abs(normal(random)) + 0.5);
    d.normalize();
    if (d.z() < 0.3) continue;
    const LightWeights weights = SphericalWeights(lights, d);
    double sum = 0;
    for (const auto& [light, weight] : weights) {
      EXPECT_GT(weight, 0);
      sum += weight;
      EXPECT_LT((lights[light] - d).norm(), 0.5);  // neighbours
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    EXPECT_LE(weights.size(), 3u);
    EXPECT_LT((Mixed(lights, weights).normalized() - d).norm(), 1e-9);
  }
}

// The triangle is the face of the hull: no light lies nearer to the chord plane's outside. Brute
// force over all triples.
TEST(LightInterpolation, TakesTheTriangleOfTheHull) {
  const std::vector<Eigen::Vector3d> lights = Dome(30);
  const Eigen::Vector3d d = Eigen::Vector3d(0.3, -0.2, 0.8).normalized();
  const LightWeights weights = SphericalWeights(lights, d);
  // The hull is convex: of all points of triangles on the ray, the face's is farthest out.
  const double distance = Mixed(lights, weights).norm();
  for (size_t a = 0; a < lights.size(); ++a) {
    for (size_t b = 0; b < a; ++b) {
      for (size_t c = 0; c < b; ++c) {
        const Eigen::Vector3d normal = (lights[b] - lights[a]).cross(lights[c] - lights[a]);
        Eigen::Matrix3d corners;
        corners << lights[a], lights[b], lights[c];
        const Eigen::Vector3d w = corners.inverse() * d;
        if (w.minCoeff() < 0) continue;
        EXPECT_LE(normal.dot(lights[a]) / normal.dot(d), distance + 1e-12);
      }
    }
  }
}

TEST(LightInterpolation, GivesALightBack) {
  const std::vector<Eigen::Vector3d> lights = Dome(40);
  for (int i = 0; i < 40; ++i) {
    EXPECT_EQ(SphericalWeights(lights, lights[i]), (LightWeights{{i, 1.0}}));
  }
}

TEST(LightInterpolation, OutsideTheDomeTheNearestEdgeDecides) {
  const std::vector<Eigen::Vector3d> lights = {{0, 0, 1}, {0.6, 0, 0.8}, {0, 0.6, 0.8}};
  EXPECT_EQ(SphericalWeights(lights, {1, 0, 0}), (LightWeights{{1, 1.0}}));
  const LightWeights middle = SphericalWeights(lights, Eigen::Vector3d(1, 1, 0.1).normalized());
  ASSERT_EQ(middle.size(), 2u);
  EXPECT_NEAR(middle[0].second, 0.5, 1e-9);
  EXPECT_NEAR(middle[1].second, 0.5, 1e-9);
}

TEST(LightInterpolation, Extremes) {
  EXPECT_THROW(SphericalWeights({}, {0, 0, 1}), Error);
  EXPECT_THROW(NearestLight({}, {0, 0, 1}), Error);
  const std::vector<Eigen::Vector3d> one = {{0, 0, 1}};
  EXPECT_EQ(SphericalWeights(one, {1, 0, 0}), (LightWeights{{0, 1.0}}));
  EXPECT_EQ(SphericalWeights(one, {0, 0, -1}), (LightWeights{{0, 1.0}}));
  // A direction twice counts once.
  const std::vector<Eigen::Vector3d> twice = {{0, 0, 1}, {0, 0, 1}, {1, 0, 0}};
  EXPECT_EQ(SphericalWeights(twice, {0, 0, 1}), (LightWeights{{0, 1.0}}));
  const LightWeights between = SphericalWeights(twice, Eigen::Vector3d(1, 0, 1).normalized());
  ASSERT_EQ(between.size(), 2u);
  EXPECT_EQ(between[0].first, 0);
  EXPECT_NEAR(between[0].second, 0.5, 1e-9);
  // Lights opposite to each other, and all on a circle.
  const std::vector<Eigen::Vector3d> circle = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  for (const auto& [light, weight] : SphericalWeights(circle, {0, 0, 1})) {
    EXPECT_TRUE(std::isfinite(weight)) << light;
  }
  EXPECT_EQ(NearestLight(circle, {0.1, 0.9, 0}), (LightWeights{{1, 1.0}}));
}

}  // namespace
}  // namespace lfm
