// SPDX-License-Identifier: BSD-3-Clause
#include "resample/view_weights.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "core/error.h"

namespace lfm {
namespace {

using Points = std::vector<Eigen::Vector2d>;

Points RandomViews(int count, unsigned seed, double radius = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-radius, radius);
  Points points;
  while (static_cast<int>(points.size()) < count) {
    const Eigen::Vector2d p(uniform(random), uniform(random));
    if (p.norm() < radius) points.push_back(p);
  }
  return points;
}

Eigen::Vector2d MixOf(const Points& views, const LightField::WeightBuffer& weights, size_t q) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (size_t k = 0; k < 3; ++k) {
    sum += static_cast<double>(weights.weight[3 * q + k]) * views[weights.view[3 * q + k]];
  }
  return sum;
}

void ExpectPartitionOfUnity(const LightField::WeightBuffer& weights, size_t queries, size_t views) {
  ASSERT_EQ(weights.seen.size(), queries);
  ASSERT_EQ(weights.view.size(), 3 * queries);
  ASSERT_EQ(weights.weight.size(), 3 * queries);
  for (size_t q = 0; q < queries; ++q) {
    float sum = 0;
    for (size_t k = 0; k < 3; ++k) {
      EXPECT_GE(weights.weight[3 * q + k], 0);
      EXPECT_LT(weights.view[3 * q + k], views);
      sum += weights.weight[3 * q + k];
    }
    EXPECT_NEAR(sum, 1, 1e-6);
  }
}

/// Distance from p to the hull of all points, by brute force over their pairs; 0 inside.
double DistanceToHull(const Points& views, const Eigen::Vector2d& p) {
  bool inside = true;
  double nearest = HUGE_VAL;
  for (const auto& a : views) {
    for (const auto& b : views) {
      if (a == b) continue;
      const Eigen::Vector2d along = b - a;
      const auto side = [&](const Eigen::Vector2d& c) {
        return along.x() * (c - a).y() - along.y() * (c - a).x();
      };
      bool is_hull = true;
      for (const auto& c : views) is_hull = is_hull && side(c) >= 0;
      if (!is_hull) continue;
      if (side(p) < 0) inside = false;
      const double t = std::min(1.0, std::max(0.0, (p - a).dot(along) / along.squaredNorm()));
      nearest = std::min(nearest, (p - a - t * along).norm());
    }
  }
  return inside ? 0 : nearest;
}

class WeightMaps : public testing::TestWithParam<DirectionMap> {};
INSTANTIATE_TEST_SUITE_P(Both, WeightMaps,
                         testing::Values(DirectionMap::kHemiOctahedral,
                                         DirectionMap::kOrthographic));

TEST_P(WeightMaps, ReproduceLinearFunctionsInsideTheHullAndItsNearestPointOutside) {
  const Points grid = GridInPlane(GetParam(), 32);
  for (const int count : {3, 7, 45}) {
    const Points views = RandomViews(count, static_cast<unsigned>(count));
    const auto weights = ComputeViewWeights(views, grid);
    ExpectPartitionOfUnity(weights, grid.size(), views.size());
    int seen = 0;
    for (size_t q = 0; q < grid.size(); ++q) {
      const double distance = DistanceToHull(views, grid[q]);
      // The weights' mixture of places is the place itself, or the nearest place in the hull.
      EXPECT_NEAR((MixOf(views, weights, q) - grid[q]).norm(), distance, 1e-6);
      if (distance > 1e-8) {
        EXPECT_EQ(weights.seen[q], 0);
      }
      if (distance == 0) {
        EXPECT_EQ(weights.seen[q], 1);
      }
      seen += weights.seen[q];
    }
    EXPECT_GT(seen, 0);
    EXPECT_LT(seen, static_cast<int>(grid.size()));
  }
}

TEST_P(WeightMaps, GiveAViewOnTheGridItsWholeWeight) {
  const Points grid = GridInPlane(GetParam(), 8);
  Points views = RandomViews(20, 3);
  views[5] = grid[27];
  const auto weights = ComputeViewWeights(views, grid);
  float of_view = 0;
  for (size_t k = 0; k < 3; ++k) {
    if (weights.view[3 * 27 + k] == 5) of_view += weights.weight[3 * 27 + k];
  }
  EXPECT_NEAR(of_view, 1, 1e-6);
  EXPECT_EQ(weights.seen[27], 1);
}

TEST(ViewWeights, DefineNoneOneAndTwoViews) {
  const Points grid = GridInPlane(DirectionMap::kHemiOctahedral, 4);
  const auto none = ComputeViewWeights(Points{}, grid);
  EXPECT_TRUE(none.view.empty() && none.weight.empty() && none.seen.empty());

  const auto one = ComputeViewWeights(Points{{0.1, 0.2}}, grid);
  ExpectPartitionOfUnity(one, grid.size(), 1);
  for (const uint8_t seen : one.seen) EXPECT_EQ(seen, 0);

  const Points two = {{-0.5, 0}, {0.5, 0}};
  const Points queries = {{0, 0.7}, {-3, 0}, {0.25, 0}};
  const auto weights = ComputeViewWeights(two, queries);
  ExpectPartitionOfUnity(weights, queries.size(), 2);
  EXPECT_LT((MixOf(two, weights, 0) - Eigen::Vector2d(0, 0)).norm(), 1e-6);
  EXPECT_LT((MixOf(two, weights, 1) - Eigen::Vector2d(-0.5, 0)).norm(), 1e-6);
  EXPECT_LT((MixOf(two, weights, 2) - Eigen::Vector2d(0.25, 0)).norm(), 1e-6);
  EXPECT_EQ(weights.seen[0], 0);
  EXPECT_EQ(weights.seen[2], 1);  // on the segment
}

TEST(ViewWeights, DefineCollinearRepeatedAndCocircularViews) {
  const Points grid = GridInPlane(DirectionMap::kHemiOctahedral, 16);
  Points circle;
  for (int i = 0; i < 16; ++i)
    circle.emplace_back(0.5 * std::cos(i * M_PI / 8), 0.5 * std::sin(i * M_PI / 8));
  const std::vector<Points> cases = {
      {{0, 0}, {0.1, 0.1}, {0.2, 0.2}, {0.7, 0.7}},
      {{0.3, 0.3}, {0.3, 0.3}, {0.3, 0.3}},
      {{0, 0}, {0, 0}, {0.5, 0}, {0.5, 0}, {0, 0.5}},
      {{0, 0}, {0.5, 1e-18}, {0.9, 0}, {0.2, -1e-17}},  // almost on one line
      {{0, 0}, {1e-200, 0}, {0, 1e-200}, {0.5, 0.5}},
      circle};
  for (const Points& views : cases) {
    const auto weights = ComputeViewWeights(views, grid);
    ExpectPartitionOfUnity(weights, grid.size(), views.size());
    for (size_t q = 0; q < grid.size(); ++q) {
      // Nowhere does the mixture lie farther away than the nearest view does.
      double nearest_view = HUGE_VAL;
      for (const auto& view : views) nearest_view = std::min(nearest_view, (view - grid[q]).norm());
      EXPECT_LE((MixOf(views, weights, q) - grid[q]).norm(), nearest_view + 1e-6);
    }
  }
}

TEST(ViewWeights, RefuseWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(ComputeViewWeights(Points{{0, 0}, {nan, 1}}, Points{{0, 0}}), Error);
}

TEST(PlaneFromDirection, StereographicPreservesCirclesOfTheSphere) {
  // A cone of directions around a tilted axis: its image must be a circle.
  const Eigen::Vector3d axis = Eigen::Vector3d(0.5, 0.3, 0.8).normalized();
  const Eigen::Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
  std::array<Eigen::Vector2d, 24> image;
  for (int i = 0; i < 24; ++i) {
    const double a = i * M_PI / 12;
    image[i] = PlaneFromDirection(
        DirectionMap::kHemiOctahedral,
        std::cos(0.6) * axis + std::sin(0.6) * (std::cos(a) * u + std::sin(a) * v));
  }
  // Centre from three points, then every other at the same distance.
  Eigen::Matrix2d system;
  system << (image[8] - image[0]).transpose(), (image[16] - image[0]).transpose();
  const Eigen::Vector2d right((image[8].squaredNorm() - image[0].squaredNorm()) / 2,
                              (image[16].squaredNorm() - image[0].squaredNorm()) / 2);
  const Eigen::Vector2d center = system.inverse() * right;
  for (const auto& p : image) EXPECT_NEAR((p - center).norm(), (image[0] - center).norm(), 1e-12);
}

TEST_P(WeightMaps, PlaneGoesOnBeyondTheHorizon) {
  double last_radius = 0;
  for (int i = 0; i <= 180; ++i) {
    const double polar = i * M_PI / 180;
    const Eigen::Vector3d d(std::sin(polar) * 0.6, std::sin(polar) * 0.8, std::cos(polar));
    const Eigen::Vector2d p = PlaneFromDirection(GetParam(), d);
    ASSERT_TRUE(p.allFinite());
    EXPECT_GE(p.norm(), last_radius);
    last_radius = p.norm();
    if (i == 90) {
      EXPECT_NEAR(p.norm(), 1, 1e-12);
    }
    if (i > 0 && i < 180) {
      EXPECT_NEAR(p.x() * 0.8, p.y() * 0.6, 1e-9 * p.norm());
    }
  }
  EXPECT_LE(last_radius, 1e3);
  EXPECT_TRUE(PlaneFromDirection(GetParam(), {0, 0, -1}).allFinite());
}

}  // namespace
}  // namespace lfm
