// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/thinning.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

TEST(ThinPoints, SmallCloudsStay) {
  const PointCloud cloud = test::MeasureCloud(test::MakeSphere(30, 3, {0, 0, 30}), 500);
  EXPECT_TRUE(ThinPoints(cloud, 1000).points == cloud.points);
  EXPECT_TRUE(ThinPoints({}, 10).points.empty());
}

TEST(ThinPoints, LeavesAboutTheNumberAndAveragesNoise) {
  const Eigen::Vector3d center(10000, 0, 30);  // ten metres away
  test::CloudNoise noise;
  noise.along_normal_mm = 0.1;
  const PointCloud cloud = test::MeasureCloud(test::MakeSphere(30, 5, center), 200000, noise);
  const PointCloud thin = ThinPoints(cloud, 8000);
  EXPECT_GT(thin.points.size(), 5000u);
  EXPECT_LT(thin.points.size(), 12000u);
  ASSERT_EQ(thin.normals.size(), thin.points.size());
  ASSERT_EQ(thin.confidence.size(), thin.points.size());
  double sum = 0;
  for (size_t i = 0; i < thin.points.size(); ++i) {
    const Eigen::Vector3d out = thin.points[i] - center;
    sum += std::abs(out.norm() - 30);
    EXPECT_GT(thin.normals[i].dot(out.normalized()), 0.9);
  }
  EXPECT_LT(sum / static_cast<double>(thin.points.size()), 0.06);
}

TEST(ThinPoints, FrontAndBackStayApart) {
  PointCloud sheet;
  for (int i = 0; i < 20000; ++i) {
    sheet.points.emplace_back(i % 200 * 0.1, i / 200 * 0.1, i % 2 == 0 ? 10 : 10.01);
    sheet.normals.emplace_back(0, 0, i % 2 == 0 ? -1 : 1);
  }
  const PointCloud thin = ThinPoints(sheet, 400);
  int up = 0, down = 0;
  for (const auto& n : thin.normals) (n.z() > 0 ? up : down) += 1;
  EXPECT_EQ(up + down, static_cast<int>(thin.points.size()));
  EXPECT_NEAR(up, down, 0.05 * up);
}

TEST(ThinPoints, ExtremesAreNamedOrWork) {
  PointCloud same;
  same.points.assign(1000, {1, 2, 3});
  EXPECT_EQ(ThinPoints(same, 10).points.size(), 1u);
  same.points[999].y() = std::numeric_limits<double>::infinity();
  EXPECT_NE(test::ErrorOf([&] { ThinPoints(same, 10); }).find("point 999"), std::string::npos);
  same.points[999].y() = 1e300;
  EXPECT_GE(ThinPoints(same, 10).points.size(), 1u);
  same.normals.resize(3);
  EXPECT_THROW(ThinPoints(same, 10), Error);
}

}  // namespace
}  // namespace lfm
