// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/normal_estimation.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/parallel.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

double AgreeingShare(const PointCloud& truth, double least_cosine) {
  PointCloud bare = truth;
  bare.normals.clear();
  const PointCloud estimated = EstimateNormals(bare);
  int agree = 0;
  for (size_t i = 0; i < truth.points.size(); ++i) {
    agree += estimated.normals[i].dot(truth.normals[i]) > least_cosine;
  }
  return static_cast<double>(agree) / static_cast<double>(truth.points.size());
}

TEST(EstimateNormals, PointOutwardsAllRound) {
  EXPECT_GT(AgreeingShare(test::MeasureCloud(test::MakeSphere(30, 4, {0, 0, 30}), 8000), 0.9),
            0.999);
  EXPECT_GT(AgreeingShare(test::MeasureCloud(test::MakeTorus(30, 10, 10, 80, 40), 12000), 0.9),
            0.995);
  // Not at the edges, where there is no one normal; but nowhere inwards.
  const PointCloud box = test::MeasureCloud(test::MakeBox({-20, -15, 0}, {20, 15, 50}, 4), 12000);
  EXPECT_GT(AgreeingShare(box, 0.9), 0.85);
  EXPECT_GT(AgreeingShare(box, 0), 0.995);
}

TEST(EstimateNormals, ExtremesGiveZeroOrUnitNormals) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  PointCloud cloud;
  EXPECT_TRUE(EstimateNormals(cloud).normals.empty());
  cloud.points = {{0, 0, 0}, {1, 0, 0}, {nan, 0, 0}, {0, 1, 0}};
  for (const auto& n : EstimateNormals(cloud).normals) EXPECT_EQ(n.norm(), 0);
  cloud.points.assign(50, {3, 4, 5});
  for (const auto& n : EstimateNormals(cloud).normals) EXPECT_EQ(n.norm(), 0);
  cloud.points.clear();
  for (int i = 0; i < 50; ++i) cloud.points.emplace_back(i, 0, 0);
  cloud.points.emplace_back(nan, nan, nan);
  const PointCloud line = EstimateNormals(cloud);
  for (size_t i = 0; i < 50; ++i) {
    EXPECT_NEAR(line.normals[i].norm(), 1, 1e-9);
    EXPECT_NEAR(line.normals[i].x(), 0, 1e-6);
  }
  EXPECT_EQ(line.normals[50].norm(), 0);
  EXPECT_EQ(line.confidence.size(), 51u);
}

TEST(EstimateNormals, SameForEveryNumberOfThreads) {
  PointCloud cloud = test::MeasureCloud(test::MakeSphere(30, 4, {0, 0, 30}), 3000);
  cloud.normals.clear();
  SetThreadCount(1);
  const PointCloud one = EstimateNormals(cloud);
  SetThreadCount(3);
  const PointCloud three = EstimateNormals(cloud);
  SetThreadCount(0);
  EXPECT_TRUE(one.normals == three.normals);
}

}  // namespace
}  // namespace lfm
