// SPDX-License-Identifier: BSD-3-Clause
#include "calib/corner_projection.h"

#include <ceres/jet.h>

#include <Eigen/Geometry>

#include "core/lens_distortion.h"

namespace lfm {
namespace {

// Points nearer than this in front of the camera cannot be pictures of the board.
constexpr double kMinDepthMm = 1e-3;
constexpr double kBehindCameraPx = 1e4;
constexpr double kBehindCameraPxPerMm = 10;

constexpr double Camera::*kOrder[kIntrinsics] = {
    &Camera::fx, &Camera::fy, &Camera::cx, &Camera::cy, &Camera::k1, &Camera::k2,
    &Camera::p1, &Camera::p2, &Camera::k3, &Camera::k4, &Camera::k5, &Camera::k6};

double BehindCamera(double depth) {
  return kBehindCameraPx + kBehindCameraPxPerMm * (kMinDepthMm - depth);
}

}  // namespace

Eigen::Matrix<double, kIntrinsics, 1> PackIntrinsics(const Camera& camera) {
  Eigen::Matrix<double, kIntrinsics, 1> values;
  for (int i = 0; i < kIntrinsics; ++i) values(i) = camera.*kOrder[i];
  return values;
}

Camera UnpackIntrinsics(const Camera& frame, const Eigen::Matrix<double, kIntrinsics, 1>& values) {
  Camera camera = frame;
  for (int i = 0; i < kIntrinsics; ++i) camera.*kOrder[i] = values(i);
  return camera;
}

CornerProjection ProjectCorner(const Camera& camera, const Pose& camera_from_world,
                               const Eigen::Vector3d& point, const Eigen::Vector2d& seen) {
  // Two coordinates, then the lens terms in the order of the intrinsics.
  constexpr int kMoving = 2 + kIntrinsics - kFirstLensTerm;
  using Jet = ceres::Jet<double, kMoving>;
  const Eigen::Vector3d turned = camera_from_world.rotation * point;
  const Eigen::Vector3d p = turned + camera_from_world.translation;
  CornerProjection result;
  result.by_intrinsics.setZero();
  Eigen::Matrix<double, 2, 3> by_p;
  if (p.z() < kMinDepthMm) {
    result.residual.setConstant(BehindCamera(p.z()));
    by_p.setZero();
    by_p.col(2).setConstant(-kBehindCameraPxPerMm);
  } else {
    const double x = p.x() / p.z(), y = p.y() / p.z();
    const LensTerms<Jet> lens{Jet(camera.k1, 2), Jet(camera.k2, 3), Jet(camera.k3, 6),
                              Jet(camera.p1, 4), Jet(camera.p2, 5), Jet(camera.k4, 7),
                              Jet(camera.k5, 8), Jet(camera.k6, 9)};
    const Eigen::Matrix<Jet, 2, 1> d = DistortNormalized(lens, Jet(x, 0), Jet(y, 1));
    const Eigen::Vector2d focal(camera.fx, camera.fy), center(camera.cx, camera.cy);
    Eigen::Matrix2d by_normalized;
    for (int row = 0; row < 2; ++row) {
      result.residual(row) = focal(row) * d(row).a + center(row) - seen(row);
      by_normalized.row(row) = focal(row) * d(row).v.template head<2>().transpose();
      result.by_intrinsics(row, row) = d(row).a;
      result.by_intrinsics(row, 2 + row) = 1;
      result.by_intrinsics.row(row).template tail<kMoving - 2>() =
          focal(row) * d(row).v.template tail<kMoving - 2>().transpose();
    }
    Eigen::Matrix<double, 2, 3> by_direction;
    by_direction << 1 / p.z(), 0, -x / p.z(), 0, 1 / p.z(), -y / p.z();
    by_p = by_normalized * by_direction;
  }
  Eigen::Matrix3d cross;
  cross << 0, -turned.z(), turned.y(), turned.z(), 0, -turned.x(), -turned.y(), turned.x(), 0;
  result.by_pose << -by_p * cross, by_p;
  result.by_point = by_p * camera_from_world.rotation;
  return result;
}

Eigen::Vector2d CornerResidual(const Camera& camera, const Pose& camera_from_world,
                               const Eigen::Vector3d& point, const Eigen::Vector2d& seen) {
  const Eigen::Vector3d p = camera_from_world * point;
  if (p.z() < kMinDepthMm) return Eigen::Vector2d::Constant(BehindCamera(p.z()));
  const Eigen::Vector2d d = Distort(camera, p.head<2>() / p.z());
  return Eigen::Vector2d(camera.fx * d.x() + camera.cx, camera.fy * d.y() + camera.cy) - seen;
}

Pose MovePose(const Pose& pose, const Eigen::Matrix<double, 6, 1>& step) {
  const Eigen::Vector3d turn = step.head<3>();
  const double angle = turn.norm();
  const Eigen::Quaterniond q = angle > 0
                                   ? Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle))
                                   : Eigen::Quaterniond::Identity();
  return Pose::FromQuaternion(Eigen::Quaterniond(q * Eigen::Quaterniond(pose.rotation)),
                              pose.translation + step.tail<3>());
}

}  // namespace lfm
