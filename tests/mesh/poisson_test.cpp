// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/poisson.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

PointCloud FullSphere(const Eigen::Vector3d& center) {
  test::CloudNoise all_round;
  all_round.hidden_below_normal_z = -2;
  all_round.hidden_below_mm = -1e9;
  return test::MeasureCloud(test::MakeSphere(30, 5, center), 20000, all_round);
}

double MeanRadiusError(const TriangleMesh& mesh, const Eigen::Vector3d& center) {
  double sum = 0;
  for (const auto& v : mesh.vertices) sum += std::abs((v - center).norm() - 30);
  return sum / static_cast<double>(mesh.vertices.size());
}

TEST(Poisson, SphereIsClosedOutwardsAndNear) {
  PoissonSettings settings;
  settings.depth = 6;
  const TriangleMesh mesh = ReconstructPoisson(FullSphere({1, 2, 3}), settings);
  EXPECT_TRUE(ExamineTopology(mesh).closed);
  EXPECT_NEAR(SignedVolume(mesh), 4.0 / 3 * M_PI * 27000, 0.005 * 4.0 / 3 * M_PI * 27000);
  EXPECT_LT(MeanRadiusError(mesh, {1, 2, 3}), 0.03);
}

TEST(Poisson, SameBytesEveryTime) {
  PoissonSettings settings;
  settings.depth = 6;
  const PointCloud cloud = FullSphere({0, 0, 30});
  const TriangleMesh a = ReconstructPoisson(cloud, settings);
  const TriangleMesh b = ReconstructPoisson(cloud, settings);
  EXPECT_TRUE(a.vertices == b.vertices);
  EXPECT_TRUE(a.triangles == b.triangles);
}

TEST(Poisson, FarFromTheOrigin) {
  PoissonSettings settings;
  settings.depth = 5;
  const Eigen::Vector3d far(3e5, -2e5, 1e5);
  EXPECT_LT(MeanRadiusError(ReconstructPoisson(FullSphere(far), settings), far), 0.05);
}

TEST(Poisson, NoPointsIsAnError) {
  EXPECT_NE(test::ErrorOf([] { ReconstructPoisson({}, {}); }), "");
}

}  // namespace
}  // namespace lfm
