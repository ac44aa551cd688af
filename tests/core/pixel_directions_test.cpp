// SPDX-License-Identifier: BSD-3-Clause
#include "core/pixel_directions.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lfm {
namespace {

Camera Lens(double k1) {
  Camera camera;
  camera.width = 64;
  camera.height = 48;
  camera.fx = camera.fy = 50;
  camera.cx = 30.3;
  camera.cy = 24.9;
  camera.k1 = k1;
  return camera;
}

TEST(PixelDirections, GoThroughPixelCentres) {
  const Camera camera = Lens(-0.1);
  const auto directions = PixelDirections(camera);
  ASSERT_EQ(directions.size(), 64u * 48u);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      const Eigen::Vector3d& direction = directions[static_cast<size_t>(y) * 64 + x];
      EXPECT_NEAR(direction.norm(), 1, 1e-14);
      const auto pixel = Project(camera, direction);
      ASSERT_TRUE(pixel);
      EXPECT_LT((*pixel - Eigen::Vector2d(x, y)).norm(), 1e-9);
    }
  }
}

// r (1 - r^2 / 2) rises up to sqrt(2/3), where it is 0.544: no direction leads further out.
TEST(PixelDirections, AreZeroWhereTheLensFolds) {
  const Camera camera = Lens(-0.5);
  const auto directions = PixelDirections(camera);
  const double fold_px = 50 * std::sqrt(2.0 / 3) * 2 / 3;
  int folded = 0;
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      const double radius_px = std::hypot(x - camera.cx, y - camera.cy);
      const bool sees = directions[static_cast<size_t>(y) * 64 + x] != Eigen::Vector3d::Zero();
      EXPECT_EQ(sees, radius_px < fold_px) << x << ", " << y;
      folded += sees ? 0 : 1;
    }
  }
  EXPECT_GT(folded, 100);
}

}  // namespace
}  // namespace lfm
