// SPDX-License-Identifier: BSD-3-Clause
#include "area_canvas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace lfm {
namespace {

TEST(AreaCanvas, PixelsGetTheAreasThatTheySee) {
  AreaCanvas canvas(12, 9);
  canvas.Add({{1.25, 2}, {3, 2}, {3, 2.75}, {1.25, 2.75}}, 2);
  EXPECT_NEAR(canvas.At(1, 2), 2 * 0.25 * 0.5, 1e-12);
  EXPECT_NEAR(canvas.At(2, 2), 2 * 1 * 0.5, 1e-12);
  EXPECT_NEAR(canvas.At(3, 2), 2 * 0.5 * 0.5, 1e-12);
  EXPECT_NEAR(canvas.At(2, 3), 2 * 1 * 0.25, 1e-12);
  EXPECT_EQ(canvas.At(4, 2), 0);
}

TEST(AreaCanvas, WhatLiesOutsideIsCutOffAndTheRestAddsUp) {
  const double angle = 0.4, side = 5;
  for (const double sense : {1.0, -1.0}) {
    AreaCanvas canvas(30, 30), edge(4, 30);
    std::vector<Eigen::Vector2d> square;
    for (int i = 0; i < 4; ++i) {
      const double turn = angle + sense * i * 1.5707963267948966;
      square.emplace_back(14.3 + side * std::cos(turn), 15.1 + side * std::sin(turn));
    }
    canvas.Add(square, 1);
    double sum = 0, most = 0;
    for (int y = 0; y < 30; ++y) {
      for (int x = 0; x < 30; ++x) {
        sum += canvas.At(x, y);
        most = std::max(most, canvas.At(x, y));
      }
    }
    EXPECT_NEAR(sum, 2 * side * side, 1e-9);
    EXPECT_NEAR(most, 1, 1e-9);
    for (Eigen::Vector2d& p : square) p.x() -= 12.8;
    edge.Add(square, 1);
    EXPECT_NEAR(edge.At(0, 15), 1, 1e-9);
  }
  AreaCanvas canvas(3, 3);
  canvas.Add({}, 1);
  canvas.Add({{1, 1}, {2, 2}}, 1);
  EXPECT_EQ(canvas.At(1, 1), 0);
}

}  // namespace
}  // namespace lfm
