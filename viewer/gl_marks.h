// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/triangle_mesh.h"
#include "viewer/gl_objects.h"
#include "viewer/gl_renderer.h"
#include "viewer/gl_view.h"

namespace lfm {

/// What is drawn of a mesh instead of its light field: a colour a corner, interpolated, darker
/// where the surface turns away from the eye. Needs a current context, the same one for its whole
/// life.
class GlCornerColors {
 public:
  explicit GlCornerColors(const TriangleMesh& mesh);
  /// 3 T colours, sRGB-coded.
  void SetColors(std::span<const Eigen::Vector3f> corners);
  void DrawInto(const GlView& view, const Placement& placement,
                EdgeOverlay edges = EdgeOverlay::kNone) const;

 private:
  Sphere bounds_;
  int corner_count_;
  GlObject program_, array_, positions_, colors_;
};

/// Whether lines are seen through what stands before them.
enum class LineDepth { kHidden, kFaintBehind };

/// Lines of one colour in the world, a pixel wide.
class GlLines {
 public:
  GlLines();
  /// `points`: pairs of ends, mm. `color`: sRGB-coded.
  void DrawInto(const GlView& view, std::span<const Eigen::Vector3d> points,
                const Eigen::Vector3f& color, LineDepth depth) const;

 private:
  GlObject program_, array_, buffer_;
};

}  // namespace lfm
