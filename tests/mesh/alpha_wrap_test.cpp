// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/alpha_wrap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mesh/self_intersection.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

TEST(AlphaWrap, HoldsTheBallThoughASideIsMissing) {
  test::CloudNoise noise;
  noise.hidden_below_normal_z = -0.5;  // an opening 52 mm wide
  const PointCloud cloud = test::MeasureCloud(test::MakeSphere(30, 4, {0, 0, 40}), 8000, noise);
  const WrapResult wrap = WrapPoints(cloud, 1.2, 0.3);
  EXPECT_TRUE(test::IsClosedManifold(wrap.mesh));
  EXPECT_TRUE(FindSelfIntersections(wrap.mesh).empty());
  const double ball = 4.0 / 3 * std::numbers::pi * 27000;
  EXPECT_GT(SignedVolume(wrap.mesh), 0.7 * ball);
  EXPECT_LT(SignedVolume(wrap.mesh), 1.1 * ball);
}

TEST(AlphaWrap, TenPointsAreEnough) {
  PointCloud ten;
  for (int i = 0; i < 8; ++i)
    ten.points.emplace_back(10 * (i & 1), 10 * (i >> 1 & 1), 10 * (i >> 2));
  ten.points.emplace_back(5, 5, 13);
  ten.points.emplace_back(5, 5, 13);
  const WrapResult wrap = WrapPoints(ten, 10, 0.5);
  EXPECT_TRUE(test::IsClosedManifold(wrap.mesh));
  EXPECT_GT(SignedVolume(wrap.mesh), 0);
}

TEST(AlphaWrap, TooFewPointsAreAnError) {
  PointCloud three;
  three.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_NE(test::ErrorOf([&] { WrapPoints(three, 1, 0.1); }).find("4"), std::string::npos);
}

}  // namespace
}  // namespace lfm
