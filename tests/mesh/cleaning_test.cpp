// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/cleaning.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

using test::ErrorOf;

const Eigen::Vector3d kCenter(0, 0, 30);

PointCloud SphereCloud(int count = 30000) {
  return test::MeasureCloud(test::MakeSphere(30, 5, kCenter), count);
}

TEST(Cleaning, KeepsTheObjectAndDropsTheRest) {
  PointCloud cloud = SphereCloud();
  const size_t object = cloud.points.size();
  test::AddPlatform(cloud, 20000, 100, 35, 0.1, 2);
  const size_t with_platform = cloud.points.size();
  test::AddOutliers(cloud, 300, 100, 100, 3);
  const CleanCloud clean = CleanPoints(cloud, {});
  EXPECT_EQ(clean.platform + clean.outside + clean.sparse + clean.detached +
                static_cast<int64_t>(clean.cloud.points.size()),
            static_cast<int64_t>(cloud.points.size()));
  EXPECT_NEAR(static_cast<double>(clean.platform), static_cast<double>(with_platform - object), 20);
  EXPECT_GT(clean.cloud.points.size(), 0.995 * object);
  int far = 0;
  for (const auto& p : clean.cloud.points) far += std::abs((p - kCenter).norm() - 30) > 2;
  EXPECT_LE(far, 10);  // of 300; some lie close to the surface
}

TEST(Cleaning, AWallsFootIsNotThePlatform) {
  PointCloud cloud = SphereCloud();
  const size_t object = cloud.points.size();
  for (const double height_mm : {0.1, 0.3}) {
    for (const Eigen::Vector3d& normal : {Eigen::Vector3d(0.8, 0, 0.6), Eigen::Vector3d(1, 0, 0)}) {
      cloud.points.emplace_back(5, 0, height_mm);
      cloud.normals.push_back(normal);
      cloud.confidence.push_back(1);
    }
  }
  const CleanCloud alone = CleanPoints(SphereCloud(), {});
  const CleanCloud clean = CleanPoints(cloud, {});
  EXPECT_EQ(clean.platform, alone.platform + 3);  // what faces up, and what is too low
  EXPECT_EQ(cloud.points.size(), object + 4);
}

TEST(Cleaning, DropsASmallPieceKeepsALargeOne) {
  PointCloud cloud = SphereCloud();
  const Eigen::Vector3d crumb_center(60, 0, 20), ball_center(0, 70, 20);
  const auto crumb = test::MeasureCloud(test::MakeSphere(3, 4, crumb_center), 300);
  const auto ball = test::MeasureCloud(test::MakeSphere(12, 4, ball_center), 4800);
  test::Append(cloud, crumb);
  test::Append(cloud, ball);
  const CleanCloud clean = CleanPoints(cloud, {});
  const auto near = [&](const Eigen::Vector3d& center, double radius) {
    return std::count_if(
        clean.cloud.points.begin(), clean.cloud.points.end(),
        [&](const Eigen::Vector3d& p) { return (p - center).norm() < radius + 1; });
  };
  EXPECT_EQ(near(crumb_center, 3), 0);
  EXPECT_GT(near(ball_center, 12), 3500);
  EXPECT_GE(clean.detached, 200);
}

TEST(Cleaning, SpacingOfAKnownCloud) {
  const CleanCloud clean = CleanPoints(SphereCloud(40000), {});
  // 40000 points on 4 pi 30^2 mm^2 (what is hidden has the same density).
  const double expected = std::sqrt(4 * M_PI * 900 / 40000);
  EXPECT_NEAR(clean.spacing_mm, expected, 0.15 * expected);
}

TEST(Cleaning, DropsWhatIsBeyondTheCameras) {
  PointCloud cloud = SphereCloud();
  const auto wall = test::MeasureCloud(test::MakeSphere(20, 4, {90, 0, 40}), 10000);
  test::Append(cloud, wall);
  CleaningLimits limits;
  limits.max_distance_mm = 70;
  const CleanCloud clean = CleanPoints(cloud, limits);
  for (const auto& p : clean.cloud.points) EXPECT_LE(p.norm(), 70);
}

TEST(Cleaning, OneWildPointDoesNoHarm) {
  PointCloud cloud = SphereCloud();
  const CleanCloud before = CleanPoints(cloud, {});
  cloud.points.emplace_back(1e12, -1e12, 1e12);
  cloud.normals.emplace_back(0, 0, 1);
  cloud.confidence.push_back(1);
  const CleanCloud after = CleanPoints(cloud, {});
  EXPECT_EQ(after.outside, before.outside + 1);
  EXPECT_EQ(after.cloud.points.size(), before.cloud.points.size());
}

TEST(Cleaning, NormalsBecomeUnitAndMissingConfidenceOne) {
  PointCloud cloud = SphereCloud(5000);
  cloud.confidence.clear();
  for (auto& n : cloud.normals) n *= 7;
  const CleanCloud clean = CleanPoints(cloud, {});
  for (const auto& n : clean.cloud.normals) EXPECT_NEAR(n.norm(), 1, 1e-12);
  for (const float c : clean.cloud.confidence) EXPECT_EQ(c, 1);
}

TEST(Cleaning, ErrorsSayWhatToCheck) {
  const auto message = [](const PointCloud& cloud) {
    return ErrorOf([&] { CleanPoints(cloud, {}); });
  };
  EXPECT_NE(message({}).find("empty"), std::string::npos);

  PointCloud platform;
  test::AddPlatform(platform, 1000, 100, 0, 0.05, 1);
  EXPECT_NE(message(platform).find("platform"), std::string::npos);

  EXPECT_NE(message(SphereCloud(80)).find("too few"), std::string::npos);

  PointCloud bad = SphereCloud(1000);
  bad.points[17].y() = std::nan("");
  EXPECT_NE(message(bad).find("point 17 is not finite"), std::string::npos);
  bad = SphereCloud(1000);
  bad.confidence[3] = std::numeric_limits<float>::infinity();
  EXPECT_NE(message(bad).find("not finite"), std::string::npos);
  bad = SphereCloud(1000);
  bad.normals.pop_back();
  EXPECT_NE(message(bad).find("normal"), std::string::npos);

  const PointCloud flat = test::MeasureCloud(test::MakeSquare(80, 30, 4), 5000);
  EXPECT_NE(message(flat).find("plane"), std::string::npos);
  PointCloud line;
  for (int i = 0; i < 500; ++i) {
    line.points.emplace_back(0.1 * i, 0, 10);
    line.normals.emplace_back(0, 0, 1);
  }
  EXPECT_NE(message(line).find("line"), std::string::npos);
  PointCloud same;
  same.points.assign(500, {1, 2, 30});
  same.normals.assign(500, {0, 0, 1});
  EXPECT_NE(message(same).find("all 500 points are the same"), std::string::npos);
}

TEST(Cleaning, ErrorsNameTheFile) {
  PointCloud same;
  same.points.assign(500, {1, 2, 30});
  same.normals.assign(500, {0, 0, 1});
  for (const PointCloud& cloud : {PointCloud{}, same, SphereCloud(80)}) {
    EXPECT_EQ(ErrorOf([&] { CleanPoints(cloud, {}, "dir/a.ply"); }).find("dir/a.ply: "), 0u);
  }
}

// A ball of 60 mm and one of half a metre, whose walls are higher than a third of the margin.
TEST(Cleaning, MetresAreNamed) {
  for (const double per_mm : {0.001, 0.008}) {
    PointCloud cloud = SphereCloud(3000);
    for (Eigen::Vector3d& p : cloud.points) p *= per_mm;
    const std::string message = ErrorOf([&] { CleanPoints(cloud, {}); });
    EXPECT_NE(message.find("looks to be in metres"), std::string::npos) << message;
    EXPECT_EQ(message.find("--platform-margin-mm"), std::string::npos) << message;
  }
  PointCloud platform;
  test::AddPlatform(platform, 1000, 100, 0, 0.05, 1);
  EXPECT_EQ(ErrorOf([&] { CleanPoints(platform, {}); }).find("metres"), std::string::npos);
}

}  // namespace
}  // namespace lfm
