// SPDX-License-Identifier: BSD-3-Clause
#include "calib/homography.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace lfm {
namespace {

constexpr double kExact_rel = 1e-10;

std::vector<Eigen::Vector2d> Map(const Eigen::Matrix3d& h, const std::vector<Eigen::Vector2d>& p) {
  std::vector<Eigen::Vector2d> mapped;
  for (const Eigen::Vector2d& x : p) mapped.push_back(MapByHomography(h, x));
  return mapped;
}

Eigen::Matrix3d Perspective() {
  Eigen::Matrix3d h;
  h << 2.1, 0.3, 400, -0.2, 1.9, 300, 0.0004, -0.0007, 1;
  return h;
}

TEST(Homography, ExactFromFourPointsAndFromMany) {
  std::vector<Eigen::Vector2d> from = {{-80, -70}, {90, -60}, {75, 88}, {-66, 79}};
  for (int i = 0; i < 2; ++i) {
    const std::vector<Eigen::Vector2d> to = Map(Perspective(), from);
    const auto h = FitHomography(from, to);
    ASSERT_TRUE(h);
    EXPECT_NEAR(h->norm(), 1, 1e-12);
    for (size_t p = 0; p < from.size(); ++p) {
      EXPECT_LT((MapByHomography(*h, from[p]) - to[p]).norm(), kExact_rel * to[p].norm());
    }
    EXPECT_LT((MapByHomography(*h, {12, -7}) - MapByHomography(Perspective(), {12, -7})).norm(),
              1e-8);
    for (int k = 0; k < 20; ++k) from.emplace_back(3.7 * k - 31, 11.0 * ((k * 5) % 9) - 40);
  }
}

TEST(Homography, HoldsFarFromTheOrigin) {
  const Eigen::Vector2d far(1e7, -3e6);
  std::vector<Eigen::Vector2d> from = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.3, 0.6}};
  for (Eigen::Vector2d& p : from) p += far;
  std::vector<Eigen::Vector2d> to;
  for (const Eigen::Vector2d& p : from) to.emplace_back(3 * p + Eigen::Vector2d(5, 6));
  const auto h = FitHomography(from, to);
  ASSERT_TRUE(h);
  for (size_t p = 0; p < from.size(); ++p) {
    EXPECT_LT((MapByHomography(*h, from[p]) - to[p]).norm(), 1e-6);
  }
}

TEST(Homography, NoAnswerWhereNothingIsDetermined) {
  const std::vector<Eigen::Vector2d> square = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  const std::vector<Eigen::Vector2d> line = {{0, 0}, {1, 1}, {2, 2}, {3, 3}};
  const std::vector<Eigen::Vector2d> repeated = {{0, 0}, {1, 0}, {1, 0}, {0, 1}};
  const std::vector<Eigen::Vector2d> same(4, Eigen::Vector2d(2, 3));
  const std::vector<Eigen::Vector2d> nan = {{0, 0}, {1, 0}, {1, std::nan("")}, {0, 1}};
  EXPECT_FALSE(FitHomography({}, {}));
  EXPECT_FALSE(FitHomography(std::span(square).first(3), std::span(square).first(3)));
  EXPECT_FALSE(FitHomography(square, std::span(square).first(3)));
  EXPECT_FALSE(FitHomography(line, line));
  EXPECT_FALSE(FitHomography(repeated, repeated));
  EXPECT_FALSE(FitHomography(same, square));
  EXPECT_FALSE(FitHomography(square, nan));
  EXPECT_FALSE(FitHomography(nan, square));
}

}  // namespace
}  // namespace lfm
