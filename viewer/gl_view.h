// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "core/camera.h"
#include "core/pose.h"
#include "viewer/scene.h"

namespace lfm {

struct Sphere {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius = 1;  ///< positive
};

/// From where OpenGL draws, and between which depths.
struct GlView {
  Camera camera;  ///< without distortion
  Pose camera_from_world;
  double near = 1, far = 2;  ///< mm along the camera's axis
};

/// The view that holds the sphere (world frame). Throws Error when the camera is not valid or has
/// lens distortion: a rasteriser draws pinhole pictures only.
GlView ViewOf(const Sphere& sphere, const Camera& camera, const Pose& camera_from_world);

/// A sphere round both.
Sphere SphereAround(const Sphere& a, const Sphere& b);
/// Where a sphere of a model's frame is in the world.
Sphere operator*(const Placement& placement, const Sphere& sphere);
/// Round the bounding box of the points, of which there is one at least.
Sphere SphereOf(std::span<const Eigen::Vector3d> points);

/// Clip space from a model's frame, moved so that `origin` (model frame) is its origin: single
/// precision is enough there. Pixel centres at integers in the picture, at halves in the window,
/// whose rows count from the bottom.
Eigen::Matrix4f ClipFromModel(const GlView& view, const Placement& placement,
                              const Eigen::Vector3d& origin);
/// The eye in that frame.
Eigen::Vector3f EyeInModel(const GlView& view, const Placement& placement,
                           const Eigen::Vector3d& origin);

/// What every drawing here begins with: no blending, no culling, no scissors, depth test "less",
/// values stored as they are.
void ResetGlState();
/// Clears colour (sRGB-coded) and depth of the bound framebuffer.
void ClearPicture(const Eigen::Vector3f& background, float alpha);

}  // namespace lfm
