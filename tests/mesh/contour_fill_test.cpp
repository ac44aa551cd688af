// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/contour_fill.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>

namespace lfm {
namespace {

using Points = std::vector<Eigen::Vector2d>;

double SignedArea(const Points& p, const std::vector<Eigen::Vector3i>& triangles) {
  double area = 0;
  for (const auto& t : triangles) {
    const Eigen::Vector2d u = p[t[1]] - p[t[0]], v = p[t[2]] - p[t[0]];
    area += 0.5 * (u.x() * v.y() - u.y() * v.x());
  }
  return area;
}

// Every edge of a contour has one triangle on its left; every other edge has two, opposite.
void ExpectBoundedBy(const std::vector<Eigen::Vector3i>& triangles,
                     const std::vector<std::vector<int>>& contours) {
  std::map<std::pair<int, int>, int> count;
  for (const auto& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      count[{t[k], t[(k + 1) % 3]}] += 1;
      count[{t[(k + 1) % 3], t[k]}] -= 1;
    }
  }
  for (const auto& c : contours) {
    for (size_t k = 0; k < c.size(); ++k) {
      count[{c[k], c[(k + 1) % c.size()]}] -= 1;
      count[{c[(k + 1) % c.size()], c[k]}] += 1;
    }
  }
  for (const auto& [edge, left] : count) EXPECT_EQ(left, 0) << edge.first << " " << edge.second;
}

TEST(ContourFill, SquareWithASquareHole) {
  const Points points = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {1, 1}, {1, 3}, {3, 3}, {3, 1}};
  const std::vector<std::vector<int>> contours = {{0, 1, 2, 3}, {4, 5, 6, 7}};
  const auto triangles = FillContours(points, contours);
  EXPECT_NEAR(SignedArea(points, triangles), 12, 1e-12);
  ExpectBoundedBy(triangles, contours);
}

TEST(ContourFill, PointsInsideAreUsedThoseOutsideNot) {
  const Points points = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}, {9, 9}, {-5, 2}};
  const auto triangles = FillContours(points, {{0, 1, 2, 3}});
  EXPECT_EQ(triangles.size(), 4u);
  for (const auto& t : triangles) EXPECT_EQ((t.array() == 4).count(), 1);
}

TEST(ContourFill, IslandInAHole) {
  const Points points = {{0, 0}, {9, 0}, {9, 9}, {0, 9}, {1, 1}, {1, 8},
                         {8, 8}, {8, 1}, {3, 3}, {5, 3}, {5, 5}, {3, 5}};
  const std::vector<std::vector<int>> contours = {{0, 1, 2, 3}, {4, 5, 6, 7}, {8, 9, 10, 11}};
  const auto triangles = FillContours(points, contours);
  EXPECT_NEAR(SignedArea(points, triangles), 81 - 49 + 4, 1e-12);
  ExpectBoundedBy(triangles, contours);
}

TEST(ContourFill, CrossingAndTouchingContoursStayClosed) {
  const Points bow = {{0, 0}, {2, 2}, {2, 0}, {0, 2}};
  ExpectBoundedBy(FillContours(bow, {{0, 1, 2, 3}}), {{0, 1, 2, 3}});
  const Points twice = {{0, 0}, {2, 0}, {2, 2}, {0, 0}, {-2, 2}, {-2, 0}};
  ExpectBoundedBy(FillContours(twice, {{0, 1, 2, 3, 4, 5}}), {{0, 1, 2, 3, 4, 5}});
  const Points on_edge = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 0}};
  ExpectBoundedBy(FillContours(on_edge, {{0, 1, 2, 3}}), {{0, 1, 2, 3}});
}

TEST(ContourFill, Nothing) {
  EXPECT_TRUE(FillContours({}, {}).empty());
  EXPECT_TRUE(FillContours({{0, 0}, {1, 0}, {0, 1}}, {}).empty());
}

}  // namespace
}  // namespace lfm
