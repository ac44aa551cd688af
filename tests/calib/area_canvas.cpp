// SPDX-License-Identifier: BSD-3-Clause
#include "area_canvas.h"

#include <algorithm>
#include <cmath>

namespace lfm {
namespace {

using Polygon = std::vector<Eigen::Vector2d>;

// The part of a polygon where sign * (p[axis] - limit) <= 0 (Sutherland-Hodgman).
Polygon Clip(const Polygon& polygon, int axis, double sign, double limit) {
  Polygon kept;
  kept.reserve(polygon.size() + 2);
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[i + 1 < polygon.size() ? i + 1 : 0];
    const double at_a = sign * (a[axis] - limit), at_b = sign * (b[axis] - limit);
    if (at_a <= 0) kept.push_back(a);
    if ((at_a <= 0) != (at_b <= 0)) kept.push_back(a + at_a / (at_a - at_b) * (b - a));
  }
  return kept;
}

Polygon Slice(const Polygon& polygon, int axis, int pixel) {
  return Clip(Clip(polygon, axis, 1, pixel + 0.5), axis, -1, pixel - 0.5);
}

double Area(const Polygon& polygon) {
  if (polygon.size() < 3) return 0;
  double twice = 0;
  for (size_t i = 1; i + 1 < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i] - polygon[0], b = polygon[i + 1] - polygon[0];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return std::abs(twice) / 2;
}

struct Range {
  int first = 0, last = -1;
};

// The pixels of a row or column of `size` that a polygon touches.
Range Touched(const Polygon& polygon, int axis, int size) {
  double low = size, high = -1;
  for (const Eigen::Vector2d& p : polygon) {
    low = std::min(low, p[axis]);
    high = std::max(high, p[axis]);
  }
  return {static_cast<int>(std::max(0.0, std::floor(low + 0.5))),
          static_cast<int>(std::min(size - 1.0, std::floor(high + 0.5)))};
}

}  // namespace

AreaCanvas::AreaCanvas(int width, int height)
    : width_(width), height_(height), sums_(static_cast<size_t>(width) * height, 0) {}

void AreaCanvas::Add(const Polygon& polygon, double amount) {
  const Range rows = Touched(polygon, 1, height_);
  for (int y = rows.first; y <= rows.last; ++y) {
    const Polygon row = Slice(polygon, 1, y);
    const Range columns = Touched(row, 0, width_);
    for (int x = columns.first; x <= columns.last; ++x) {
      sums_[static_cast<size_t>(y) * width_ + x] += amount * Area(Slice(row, 0, x));
    }
  }
}

}  // namespace lfm
