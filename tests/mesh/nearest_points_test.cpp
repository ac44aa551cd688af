// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/nearest_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace lfm {
namespace {

TEST(NearestPoints, AgreesWithTryingAll) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-10, 10);
  std::vector<Eigen::Vector3d> points(500);
  for (auto& p : points) p = {place(random), place(random), place(random)};
  const NearestPoints index(points);
  for (int q = 0; q < 50; ++q) {
    const Eigen::Vector3d query(place(random), place(random), place(random));
    std::vector<double> all;
    for (const auto& p : points) all.push_back((p - query).norm());
    std::sort(all.begin(), all.end());
    const auto found = index.Find(query, 7);
    ASSERT_EQ(found.size(), 7u);
    for (int k = 0; k < 7; ++k) {
      EXPECT_NEAR(found[k].distance, all[k], 1e-12);
      EXPECT_NEAR((points[found[k].index] - query).norm(), found[k].distance, 1e-12);
    }
  }
}

TEST(NearestPoints, FewerThanAsked) {
  const std::vector<Eigen::Vector3d> points = {{0, 0, 0}, {1, 0, 0}};
  EXPECT_EQ(NearestPoints(points).Find({0.1, 0, 0}, 5).size(), 2u);
  const std::vector<Eigen::Vector3d> none;
  EXPECT_TRUE(NearestPoints(none).Find({0, 0, 0}, 5).empty());
}

}  // namespace
}  // namespace lfm
