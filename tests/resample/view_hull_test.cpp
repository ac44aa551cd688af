// SPDX-License-Identifier: BSD-3-Clause
#include "resample/view_hull.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "resample/view_weights.h"

namespace lfm {
namespace {

using Points = std::vector<Eigen::Vector2d>;

Points Scattered(int count, unsigned seed, double extent) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-extent, extent);
  Points points(static_cast<size_t>(count));
  for (auto& p : points) p = {uniform(random), 0.3 + 0.5 * uniform(random)};
  return points;
}

double Side(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// Whether p is a convex combination of three of the points: by brute force over all triples.
bool InSomeTriangle(const Points& points, const Eigen::Vector2d& p, double slack) {
  for (const auto& a : points) {
    for (const auto& b : points) {
      for (const auto& c : points) {
        if (Side(a, b, c) <= 1e-12) continue;
        if (Side(a, b, p) >= -slack && Side(b, c, p) >= -slack && Side(c, a, p) >= -slack) {
          return true;
        }
      }
    }
  }
  return false;
}

/// The distance to the nearest point of all segments between points, which hold the hull's edges;
/// 0 inside.
double DistanceToAll(const Points& points, const Eigen::Vector2d& p) {
  if (InSomeTriangle(points, p, 0)) return 0;
  double nearest = HUGE_VAL;
  for (const auto& a : points) {
    for (const auto& b : points) {
      const Eigen::Vector2d along = b - a;
      const double t = along.squaredNorm() > 0
                           ? std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0)
                           : 0;
      nearest = std::min(nearest, (a + t * along - p).norm());
    }
  }
  return nearest;
}

Points DrawnIn(const Points& views, double margin) {
  Eigen::Vector2d mean(0, 0);
  for (const auto& view : views) mean += view / static_cast<double>(views.size());
  Points drawn;
  for (const auto& view : views) drawn.push_back(mean + (1 - margin) * (view - mean));
  return drawn;
}

TEST(ViewHull, DrawsPointsInToTheNearestOfTheSmallerHull) {
  for (const int count : {3, 5, 20}) {
    const Points views = Scattered(count, static_cast<unsigned>(count), 0.8);
    const ViewTriangulation triangulation = TriangulateViews(views);
    for (const double margin : {0.0, 0.08, 0.5}) {
      const ViewHull hull(views, triangulation, margin);
      const Points smaller = DrawnIn(views, margin);
      int moved = 0;
      for (const auto& p : Scattered(60, 99, 1.2)) {
        const Eigen::Vector2d drawn = hull.DrawIn(p);
        EXPECT_NEAR((drawn - p).norm(), DistanceToAll(smaller, p), 1e-9);
        EXPECT_TRUE(InSomeTriangle(smaller, drawn, 1e-9));
        EXPECT_EQ(hull.Contains(p), InSomeTriangle(views, p, 0));
        moved += drawn != p ? 1 : 0;
      }
      EXPECT_GT(moved, 10);
      if (count == 20) {
        EXPECT_LT(moved, 60);
      }
    }
  }
}

TEST(ViewHull, OfViewsOnOneLineDoesNothing) {
  for (const Points& views : {Points{}, Points{{0.1, 0.2}}, Points{{0, 0}, {1, 1}},
                              Points{{0, 0}, {0.5, 0.5}, {1, 1}}, Points{{0, 0}, {0, 0}}}) {
    const ViewHull hull(views, TriangulateViews(views), 0.1);
    EXPECT_FALSE(hull.Contains({0, 0}));
    EXPECT_EQ(hull.DrawIn({3, 4}), Eigen::Vector2d(3, 4));
  }
}

TEST(ViewHull, MovesViewWeightsNotWhatCountsAsSeen) {
  const Points views = Scattered(20, 7, 0.8), queries = Scattered(300, 8, 1.2);
  const ViewHull hull(views, TriangulateViews(views), 0.08);
  const auto plain = ComputeViewWeights(views, queries);
  const auto drawn = ComputeViewWeights(views, queries, 0.08);
  EXPECT_EQ(plain.seen, drawn.seen);
  int inside_border = 0;
  for (size_t q = 0; q < queries.size(); ++q) {
    Eigen::Vector2d mix(0, 0);
    double sum = 0;
    for (size_t k = 0; k < 3; ++k) {
      EXPECT_GE(drawn.weight[3 * q + k], 0);
      sum += drawn.weight[3 * q + k];
      mix += static_cast<double>(drawn.weight[3 * q + k]) * views[drawn.view[3 * q + k]];
    }
    EXPECT_NEAR(sum, 1, 1e-6);
    EXPECT_NEAR((mix - hull.DrawIn(queries[q])).norm(), 0, 1e-6);
    inside_border += plain.seen[q] != 0 && hull.DrawIn(queries[q]) != queries[q] ? 1 : 0;
  }
  EXPECT_GT(inside_border, 3);
}

}  // namespace
}  // namespace lfm
