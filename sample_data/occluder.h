// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/pose.h"
#include "core/triangle_mesh.h"
#include "sample_data/lighting.h"
#include "sample_data/photo_renderer.h"
#include "sample_data/pixel_rays.h"
#include "sample_data/random.h"
#include "sample_data/trouble.h"

namespace lfm {

/// All points within `radius` of the segment from a to b; mm, world frame.
struct Capsule {
  Eigen::Vector3d a = {0, 0, 0}, b = {0, 0, 0};
  double radius = 1;
};

/// Where a ray meets a capsule first.
struct CapsuleHit {
  double distance = 0;  ///< in lengths of the direction
  Eigen::Vector3d normal = {0, 0, 1};
};

/// No answer when the ray (from outside, `direction` of any length but 0) passes by.
std::optional<CapsuleHit> IntersectCapsule(const Capsule& capsule, const Eigen::Vector3d& origin,
                                           const Eigen::Vector3d& direction);

/// A matt thing between the camera and the platform: a stick, or a hand with its forearm.
struct Occluder {
  std::vector<Capsule> capsules;
  Eigen::Vector3f albedo = {0.5f, 0.5f, 0.5f};
};

/// An occluder that reaches into the picture from a random side, its tip near the middle (a stick)
/// or between there and the border (a hand), at 40 to 60 % of the way to `center`: nearer than
/// anything that stands on the platform.
Occluder MakeOccluder(OccluderKind kind, const Camera& camera, const Pose& camera_from_world,
                      const Eigen::Vector3d& center, RandomStream& random);

/// The capsules as closed meshes with smooth normals, inscribed: corners on the true surface, the
/// middles of facets less than 0.3 % of the radius below it.
TriangleMesh OccluderMesh(const Occluder& occluder);

/// Pixels whose centre the occluder covers leave the mask.
void MaskOccluder(const Occluder& occluder, const PixelRays& rays, const Pose& camera_from_world,
                  Image& mask);

/// Draws the occluder over a rendered photograph of the same rays and pose, 16 samples a pixel
/// where it covers one; pixels whose centre it covers leave the mask. It is lit by the lamps, which
/// it hides from itself only where they are below its own horizon, and by the room. What it casts
/// on the scene is occluder_shadow.h's.
void CoverWithOccluder(const Occluder& occluder, const Lighting& lighting, const PixelRays& rays,
                       const Pose& camera_from_world, RenderedPhoto& photo);

}  // namespace lfm
