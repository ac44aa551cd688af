// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <vector>

namespace lfm {

/// Corners in order, either way round; fewer than three enclose nothing.
using Polygon = std::vector<Eigen::Vector2d>;

/// The part of a polygon where axis . p < limit (Sutherland and Hodgman). Of one that is not convex
/// parts may stay joined by edges without area.
inline Polygon ClipPolygon(const Polygon& polygon, const Eigen::Vector2d& axis, double limit) {
  Polygon kept;
  kept.reserve(polygon.size() + 2);
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[i + 1 < polygon.size() ? i + 1 : 0];
    const double at_a = axis.dot(a) - limit, at_b = axis.dot(b) - limit;
    if (at_a < 0) kept.push_back(a);
    if ((at_a < 0) != (at_b < 0)) kept.push_back(a + at_a / (at_a - at_b) * (b - a));
  }
  return kept;
}

/// Not negative.
inline double PolygonArea(const Polygon& polygon) {
  double twice = 0;
  for (size_t i = 2; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i - 1] - polygon[0], b = polygon[i] - polygon[0];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return std::abs(twice) / 2;
}

}  // namespace lfm
