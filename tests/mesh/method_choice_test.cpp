// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/method_choice.h"

#include <gtest/gtest.h>

#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

TEST(MethodChoice, FollowsTheNormals) {
  PointCloud cloud = test::MeasureCloud(test::MakeSphere(30, 4, {0, 0, 30}), 6000);
  const CloudLook good = LookAtCloud(cloud);
  EXPECT_GT(good.normal_agreement, 0.98);
  EXPECT_EQ(ChooseMethod(good, SurfaceMethod::kAuto).method, SurfaceMethod::kPoisson);

  for (size_t i = 0; i < cloud.normals.size(); i += 2) cloud.normals[i] = -cloud.normals[i];
  const MethodChoice flipped = ChooseMethod(LookAtCloud(cloud), SurfaceMethod::kAuto);
  EXPECT_EQ(flipped.method, SurfaceMethod::kWrap);
  EXPECT_NE(flipped.reason.find("normals"), std::string::npos);

  for (auto& n : cloud.normals) n = Eigen::Vector3d::UnitZ();
  EXPECT_LT(LookAtCloud(cloud).normal_agreement, 0.4);
}

TEST(MethodChoice, FewPointsAreWrappedAndWhatIsAskedIsKept) {
  const MethodChoice few = ChooseMethod({499, 1}, SurfaceMethod::kAuto);
  EXPECT_EQ(few.method, SurfaceMethod::kWrap);
  EXPECT_NE(few.reason.find("499"), std::string::npos);
  EXPECT_EQ(ChooseMethod({500, 1}, SurfaceMethod::kAuto).method, SurfaceMethod::kPoisson);
  EXPECT_EQ(ChooseMethod({3, 0}, SurfaceMethod::kPoisson).method, SurfaceMethod::kPoisson);
  EXPECT_EQ(ChooseMethod({1000000, 1}, SurfaceMethod::kWrap).method, SurfaceMethod::kWrap);
  EXPECT_EQ(LookAtCloud({}).points, 0);
}

}  // namespace
}  // namespace lfm
