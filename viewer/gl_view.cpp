// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/gl_view.h"

#include <epoxy/gl.h>

#include <algorithm>

#include "core/error.h"

namespace lfm {
namespace {

constexpr double kDepthMargin = 1.01, kLeastDepthShare = 1e-3;

Eigen::Matrix4d ClipFromCamera(const GlView& view) {
  const Camera& camera = view.camera;
  Eigen::Matrix4d clip = Eigen::Matrix4d::Zero();
  clip(0, 0) = 2 * camera.fx / camera.width;
  clip(0, 2) = 2 * (camera.cx + 0.5) / camera.width - 1;
  clip(1, 1) = -2 * camera.fy / camera.height;
  clip(1, 2) = 1 - 2 * (camera.cy + 0.5) / camera.height;
  clip(2, 2) = (view.far + view.near) / (view.far - view.near);
  clip(2, 3) = -2 * view.far * view.near / (view.far - view.near);
  clip(3, 2) = 1;
  return clip;
}

}  // namespace

GlView ViewOf(const Sphere& sphere, const Camera& camera, const Pose& camera_from_world) {
  ValidateCamera(camera, "the camera to draw");
  if (camera.HasDistortion()) {
    throw Error(
        "OpenGL draws pinhole pictures and this camera's lens distorts; use lfm-render "
        "--renderer cpu");
  }
  GlView view{camera, camera_from_world};
  const double depth = (camera_from_world * sphere.center).z();
  const double reach = kDepthMargin * sphere.radius;
  view.far = std::max(depth + reach, kLeastDepthShare * sphere.radius);
  view.near = std::max(depth - reach, kLeastDepthShare * view.far);
  return view;
}

Sphere SphereAround(const Sphere& a, const Sphere& b) {
  const Eigen::Vector3d offset = b.center - a.center;
  const double distance = offset.norm();
  if (distance + b.radius <= a.radius) return a;
  if (distance + a.radius <= b.radius) return b;
  const double radius = (distance + a.radius + b.radius) / 2;
  return {a.center + offset * ((radius - a.radius) / distance), radius};
}

Sphere operator*(const Placement& placement, const Sphere& sphere) {
  return {placement * sphere.center, placement.scale * sphere.radius};
}

Sphere SphereOf(std::span<const Eigen::Vector3d> points) {
  Eigen::Vector3d low = points[0], high = low;
  for (const Eigen::Vector3d& point : points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  return {(low + high) / 2, std::max((high - low).norm() / 2, 1e-6)};
}

Eigen::Matrix4f ClipFromModel(const GlView& view, const Placement& placement,
                              const Eigen::Vector3d& origin) {
  const Pose camera_from_model = view.camera_from_world * placement.world_from_model;
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = placement.scale * camera_from_model.rotation;
  matrix.topRightCorner<3, 1>() = camera_from_model * (placement.scale * origin);
  return (ClipFromCamera(view) * matrix).cast<float>();
}

Eigen::Vector3f EyeInModel(const GlView& view, const Placement& placement,
                           const Eigen::Vector3d& origin) {
  const Eigen::Vector3d eye =
      placement.world_from_model.Inverse() * view.camera_from_world.Center() / placement.scale;
  return (eye - origin).cast<float>();
}

void ResetGlState() {
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_FRAMEBUFFER_SRGB);
  glDisable(GL_DITHER);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
}

void ClearPicture(const Eigen::Vector3f& background, float alpha) {
  ResetGlState();
  glClearColor(background[0], background[1], background[2], alpha);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

}  // namespace lfm
