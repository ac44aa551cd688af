// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/camera.h"
#include "core/pose.h"
#include "core/ray_scene.h"
#include "core/triangle_mesh.h"

namespace lfm {

/// What a photograph sees of a surface, rows from the top: the camera's Z (mm) of the first hit of
/// each pixel's ray, infinite where there is none.
struct DepthMap {
  int width = 0, height = 0;
  std::vector<float> depth;

  float At(int x, int y) const { return depth[static_cast<size_t>(y) * width + x]; }
};

/// Casts a ray through every pixel centre of the part of the picture that holds `surface` (whose
/// prepared form is `scene`), lens distortion included: `directions` are PixelDirections(camera).
/// Runs in the calling thread: callers have many photographs.
DepthMap RenderDepth(const TriangleMesh& surface, const RayScene& scene, const Camera& camera,
                     const std::vector<Eigen::Vector3d>& directions, const Pose& camera_from_world);

/// What a pixel is good for.
enum class PixelUse : uint8_t {
  kForbidden,  ///< outside the photograph's mask: nothing may be sampled here
  kNearEdge,   ///< mixes with what lies beside it, or shows nothing of the surface: no data
  kData,
};

/// kData for each pixel that shows the surface and lies at least `margin_px` from every depth edge,
/// else kNearEdge.
///
/// A depth edge runs between two pixels (4-neighbours) when only one of them shows the surface, or
/// when their depths differ by more than four times a pixel's size on the surface plus twice the
/// smaller of the depth steps that the two sides show just beside it: a surface may be steep, and
/// turn away steadily, without being torn apart. Both sides keep the margin, because the nearer one
/// mixes with what lies behind it. An edge counts as half-way between the two pixels, which is
/// right to half a pixel. The pixel next to an edge is half a pixel from it: a margin up to 0.5
/// keeps every pixel that shows the surface.
std::vector<PixelUse> FindUsablePixels(const DepthMap& map, const Camera& camera, double margin_px);

}  // namespace lfm
