// SPDX-License-Identifier: BSD-3-Clause
#include "resample/view_triangulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "core/error.h"

namespace lfm {
namespace {

using Points = std::vector<Eigen::Vector2d>;

double Orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// Positive when d lies inside the circle through a, b, c (counter-clockwise), in long double.
long double InCircle(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                     const Eigen::Vector2d& d) {
  using L = long double;
  const auto row = [&](const Eigen::Vector2d& p) {
    const L x = L(p.x()) - L(d.x()), y = L(p.y()) - L(d.y());
    return std::array<L, 3>{x, y, x * x + y * y};
  };
  const auto p = row(a), q = row(b), r = row(c);
  return p[0] * (q[1] * r[2] - q[2] * r[1]) - p[1] * (q[0] * r[2] - q[2] * r[0]) +
         p[2] * (q[0] * r[1] - q[1] * r[0]);
}

Points RandomPoints(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Points points;
  for (int i = 0; i < count; ++i) points.emplace_back(uniform(random), uniform(random));
  return points;
}

TEST(ViewTriangulation, HasEmptyCircumcirclesAndCoversTheHull) {
  for (const int count : {3, 4, 10, 45, 100}) {
    const Points points = RandomPoints(count, static_cast<unsigned>(count));
    const ViewTriangulation result = TriangulateViews(points);
    double area = 0, hull_area = 0;
    for (const auto& face : result.faces) {
      const auto &a = points[face.views[0]], &b = points[face.views[1]], &c = points[face.views[2]];
      EXPECT_GT(Orientation(a, b, c), 0);
      area += Orientation(a, b, c) / 2;
      for (const Eigen::Vector2d& d : points) EXPECT_LE(InCircle(a, b, c, d), 1e-15L);
    }
    for (const auto& [a, b] : result.hull) {
      hull_area += (points[a].x() * points[b].y() - points[a].y() * points[b].x()) / 2;
      for (const Eigen::Vector2d& d : points) {
        EXPECT_GE(Orientation(points[a], points[b], d), -1e-15);
      }
    }
    EXPECT_NEAR(area, hull_area, 1e-12);
    // Euler: faces = 2 n - 2 - h.
    EXPECT_EQ(result.faces.size(), 2 * points.size() - 2 - result.hull.size());
  }
}

TEST(ViewTriangulation, NeighborsAreMutual) {
  const Points points = RandomPoints(30, 7);
  const ViewTriangulation result = TriangulateViews(points);
  for (int f = 0; f < static_cast<int>(result.faces.size()); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int other = result.faces[f].neighbors[k];
      if (other < 0) continue;
      const auto& back = result.faces[other].neighbors;
      EXPECT_NE(std::find(back.begin(), back.end(), f), back.end());
      // The edge opposite to corner k is shared: the corner itself is not in the neighbour.
      const auto& views = result.faces[other].views;
      EXPECT_EQ(std::find(views.begin(), views.end(), result.faces[f].views[k]), views.end());
    }
  }
}

TEST(ViewTriangulation, DefinesEveryDegenerateInput) {
  EXPECT_TRUE(TriangulateViews(Points{}).distinct.empty());
  const ViewTriangulation one = TriangulateViews(Points{{1, 2}});
  EXPECT_EQ(one.distinct, std::vector<int>{0});
  EXPECT_TRUE(one.hull.empty());
  const ViewTriangulation two = TriangulateViews(Points{{1, 2}, {3, 4}});
  EXPECT_EQ(two.hull.size(), 1u);
  const ViewTriangulation line = TriangulateViews(Points{{2, 2}, {0, 0}, {3, 3}, {1, 1}});
  EXPECT_TRUE(line.faces.empty());
  const std::vector<std::array<int, 2>> expected = {{1, 3}, {3, 0}, {0, 2}};
  EXPECT_EQ(line.hull, expected);
}

TEST(ViewTriangulation, KeepsTheFirstOfRepeatedPoints) {
  const Points points = {{0, 0}, {1, 0}, {0, 0}, {0, 1}, {1, 0}};
  const ViewTriangulation result = TriangulateViews(points);
  EXPECT_EQ(result.distinct, (std::vector<int>{0, 1, 3}));
  ASSERT_EQ(result.faces.size(), 1u);
  const auto& views = result.faces[0].views;
  EXPECT_EQ(std::set<int>(views.begin(), views.end()), (std::set<int>{0, 1, 3}));
}

TEST(ViewTriangulation, TriangulatesPointsOnOneCircle) {
  Points points;
  for (int i = 0; i < 12; ++i)
    points.emplace_back(std::cos(i * 0.5235987755982988), std::sin(i * 0.5235987755982988));
  const ViewTriangulation result = TriangulateViews(points);
  EXPECT_EQ(result.faces.size(), 2 * points.size() - 2 - result.hull.size());
}

TEST(ViewTriangulation, RefusesWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(TriangulateViews(Points{{0, 0}, {nan, 1}}), Error);
  EXPECT_THROW(TriangulateViews(Points{{HUGE_VAL, 0}}), Error);
}

}  // namespace
}  // namespace lfm
