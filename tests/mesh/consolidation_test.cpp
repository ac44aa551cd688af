// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/consolidation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "mesh/cleaning.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

const Eigen::Vector3d kCenter(0, 0, 30);

PointCloud SphereCloud(int count) {
  return test::MeasureCloud(test::MakeSphere(30, 5, kCenter), count);
}

TEST(Consolidate, LowersNoiseWithoutBias) {
  const PointCloud cloud = CleanPoints(SphereCloud(120000), {}).cloud;
  const PointCloud averaged = ConsolidatePoints(cloud, 1.0);
  EXPECT_LT(averaged.points.size(), cloud.points.size() / 4);
  const auto errors = [&](const PointCloud& c) {
    double sum = 0, squares = 0;
    for (const auto& p : c.points) {
      const double e = (p - kCenter).norm() - 30;
      sum += e;
      squares += e * e;
    }
    const double n = static_cast<double>(c.points.size());
    return std::pair(sum / n, std::sqrt(squares / n));
  };
  EXPECT_NEAR(errors(cloud).second, 0.04, 0.003);
  EXPECT_LT(errors(averaged).second, 0.028);
  // The mean of a cap 1 mm wide lies 1^2 / 24 R = 0.0014 mm inside, twice that for its diagonal.
  EXPECT_NEAR(errors(averaged).first, errors(cloud).first, 0.005);
}

TEST(Consolidate, DropsPointsOffTheSurface) {
  PointCloud cloud = SphereCloud(60000);
  for (size_t i = 0; i < cloud.points.size(); i += 400) {
    cloud.points[i] += (i % 800 ? 1.0 : -1.0) * cloud.normals[i];
  }
  const PointCloud clean = ConsolidatePoints(CleanPoints(cloud, {}).cloud, 0.3);
  int off = 0;
  for (const auto& p : clean.points) off += std::abs((p - kCenter).norm() - 30) > 0.5;
  EXPECT_LE(off, 5);  // of 137
  EXPECT_GT(clean.points.size(), 20000u);
}

TEST(Consolidate, KeepsFrontAndBackApart) {
  PointCloud sheet;
  for (int i = 0; i < 400; ++i) {
    for (const double side : {-1.0, 1.0}) {
      sheet.points.emplace_back(i % 20, i / 20, 10 + 0.05 * side);
      sheet.normals.emplace_back(0, 0, side);
      sheet.confidence.push_back(1);
    }
  }
  for (const auto& p : ConsolidatePoints(sheet, 5).points) EXPECT_GT(std::abs(p.z() - 10), 0.04);
}

TEST(Consolidate, NoPoints) { EXPECT_TRUE(ConsolidatePoints({}, 1).points.empty()); }

}  // namespace
}  // namespace lfm
