// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/polygon.h"

namespace lfm {

/// A picture of polygons, each pixel by the exact areas that it sees of them: no sampling pattern
/// that would misjudge parallel edges alike.
class AreaCanvas {
 public:
  AreaCanvas(int width, int height);

  /// Adds `amount` times the area that the polygon covers of each pixel (their middles at whole
  /// numbers). The polygon need not be convex; its sense of rotation does not matter.
  void Add(const Polygon& polygon, double amount);
  double At(int x, int y) const { return sums_[static_cast<size_t>(y) * width_ + x]; }

 private:
  int width_, height_;
  std::vector<double> sums_;
};

}  // namespace lfm
