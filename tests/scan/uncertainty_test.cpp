// SPDX-License-Identifier: BSD-3-Clause
#include "scan/uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "scan/triangulate.h"
#include "scan/world_cloud.h"
#include "tests/scan/synthetic_rig.h"

namespace lfm {
namespace {

using testing::KnownRig;
using testing::TurnedPlatform;

TEST(ColumnSigma, IsThatOfProjectorsDrawnFromTheCovariance) {
  const RigCalibration rig = KnownRig(true);
  RigUncertainty uncertainty;
  Eigen::Matrix<double, 14, 1> sigma;
  sigma << 0.3, 0.3, 0.2, 0.2, 1e-3, 1e-2, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 0.05, 0.05, 0.08;
  uncertainty.projector = sigma.cwiseAbs2().asDiagonal();
  const Eigen::Vector3d point = TurnedPlatform(0) * Eigen::Vector3d(35, -20, 60);
  const double stated = ColumnSigmaPx(rig, uncertainty, point);

  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, 1);
  const double center = Project(rig.projector, rig.projector_from_camera * point)->x();
  constexpr int kDraws = 20000;
  double sum = 0;
  for (int i = 0; i < kDraws; ++i) {
    Eigen::Matrix<double, 14, 1> d;
    for (int k = 0; k < 14; ++k) d(k) = sigma(k) * normal(random);
    Camera c = rig.projector;
    c.fx += d(0), c.fy += d(1), c.cx += d(2), c.cy += d(3);
    c.k1 += d(4), c.k2 += d(5), c.p1 += d(6), c.p2 += d(7);
    const Eigen::Vector3d w = d.segment<3>(8);
    const Pose pose{Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix() *
                        rig.projector_from_camera.rotation,
                    rig.projector_from_camera.translation + d.tail<3>()};
    sum += std::pow(Project(c, pose * point)->x() - center, 2);
  }
  EXPECT_NEAR(stated, std::sqrt(sum / kDraws), 0.03 * stated);
  EXPECT_EQ(ColumnSigmaPx(rig, {}, point), 0);
  EXPECT_EQ(ColumnSigmaPx(rig, uncertainty, {0, 0, -1e6}), 0);
}

TEST(PoseVariance, IsThatOfPosesDrawnFromTheCovariance) {
  const Pose pose = TurnedPlatform(20);
  const Eigen::Vector3d in_camera = pose * Eigen::Vector3d(40, 10, 90);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.2, -0.9).normalized();
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  covariance.diagonal() << 1e-8, 4e-8, 2e-8, 1e-4, 2e-4, 5e-4;
  const double stated = PoseVarianceMm2(covariance, in_camera - pose.translation, normal);
  std::mt19937 random(6);
  std::normal_distribution<double> gauss(0, 1);
  constexpr int kDraws = 20000;
  double sum = 0;
  for (int i = 0; i < kDraws; ++i) {
    Eigen::Matrix<double, 6, 1> d;
    for (int k = 0; k < 6; ++k) d(k) = std::sqrt(covariance(k, k)) * gauss(random);
    const Eigen::Vector3d w = d.head<3>();
    const Pose off{Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix() * pose.rotation,
                   pose.translation + d.tail<3>()};
    const Eigen::Vector3d world = off.Inverse() * in_camera;
    sum +=
        std::pow((pose.rotation.transpose() * normal).dot(world - pose.Inverse() * in_camera), 2);
  }
  EXPECT_NEAR(stated, sum / kDraws, 0.05 * stated);
}

TEST(WorldCloud, JoinsScansInOrderAndAddsThePosesVariance) {
  const Camera camera = KnownRig(false).camera;
  const std::vector<Eigen::Vector2d> rays = NormalizedRays(camera);
  Board board;
  board.width_mm = board.height_mm = 200;
  PosedRange range;
  range.camera_from_world = TurnedPlatform(0);
  range.map.width = camera.width;
  range.map.height = camera.height;
  range.map.depth.assign(rays.size(), 0);
  range.map.normal.assign(rays.size(), Eigen::Vector3f::Zero());
  range.map.confidence.assign(rays.size(), 0);
  range.map.sigma_mm.assign(rays.size(), 0);
  const size_t middle = static_cast<size_t>(camera.height / 2) * camera.width + camera.width / 2;
  const auto put = [&](size_t p, double height) {  // a point so high above the plate
    const Eigen::Vector3d n = range.camera_from_world.rotation.col(2);
    const double distance = n.dot(range.camera_from_world.translation) + height;
    range.map.depth[p] = distance / n.dot(rays[p].homogeneous());
    range.map.normal[p] = n.cast<float>();
    range.map.confidence[p] = 0.5F;
    range.map.sigma_mm[p] = 0.03F;
  };
  put(middle, 5);
  put(middle + 1, 0.3);  // the plate's
  put(middle + 2, 0.1);  // the corner between plate and wall
  put(middle + 3, 0.3);  // a wall's foot
  for (size_t p : {middle + 2, middle + 3}) {
    range.map.normal[p] = range.camera_from_world.rotation.col(0).cast<float>();
  }
  put(middle + 4, 0.5);  // may be the plate's
  range.map.sigma_mm[middle + 4] = 0.3F;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  covariance.diagonal().tail<3>().setConstant(0.04 * 0.04);
  PointCloud cloud = CloudFromRange(range, covariance, rays, board);
  ASSERT_EQ(cloud.points.size(), 2U);
  EXPECT_NEAR(cloud.points[1].z(), 0.3, 1e-9);
  range.map.depth[middle + 3] = 0;
  cloud = CloudFromRange(range, covariance, rays, board);
  ASSERT_EQ(cloud.points.size(), 1U);
  EXPECT_NEAR(cloud.points[0].z(), 5, 1e-9);
  EXPECT_NEAR(cloud.sigma_mm[0], 0.05, 1e-6);
  const PointCloud both = Concatenate({{"a", cloud, {}}, {"b", {}, {}}, {"c", cloud, {}}});
  ASSERT_EQ(both.points.size(), 2U);
  EXPECT_EQ(both.points[1], cloud.points[0]);
  EXPECT_EQ(both.sigma_mm.size(), 2U);
  EXPECT_TRUE(Concatenate({}).points.empty());
}

}  // namespace
}  // namespace lfm
