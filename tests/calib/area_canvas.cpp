// SPDX-License-Identifier: BSD-3-Clause
#include "area_canvas.h"

#include <algorithm>
#include <cmath>

namespace lfm {
namespace {

Polygon Slice(const Polygon& polygon, int axis, int pixel) {
  const Eigen::Vector2d along = Eigen::Vector2d::Unit(axis);
  return ClipPolygon(ClipPolygon(polygon, along, pixel + 0.5), -along, 0.5 - pixel);
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
      sums_[static_cast<size_t>(y) * width_ + x] += amount * PolygonArea(Slice(row, 0, x));
    }
  }
}

}  // namespace lfm
