// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "viewer/gl_marks.h"
#include "viewer/gl_renderer.h"
#include "viewer/overlay_colors.h"
#include "viewer/scene.h"

namespace lfm {

/// Draws what a scene's models are made of instead of their light fields: one scale of colours and
/// one legend for all of them. Needs a current context, the same one for its whole life.
class SceneOverlay {
 public:
  /// Forgets the models: they are others, or have moved.
  void Clear() { models_.clear(), shown_ = Overlay::kNone; }
  void Recolor() { shown_ = Overlay::kNone; }

  /// `count_photographs`: of the first model's vertices, asked for once; empty: not known.
  void DrawInto(const GlView& view, const Scene& scene, Overlay overlay, EdgeOverlay edges,
                const std::function<std::vector<int>()>& count_photographs);
  const std::vector<LegendEntry>& legend() const { return legend_; }

 private:
  void Color(const Scene& scene, Overlay overlay, const Eigen::Vector3d& eye,
             const std::function<std::vector<int>()>& count_photographs);
  std::vector<GlCornerColors> models_;
  std::vector<int> photographs_;
  Overlay shown_ = Overlay::kNone;
  Eigen::Vector3d eye_ = Eigen::Vector3d::Zero();
  std::vector<LegendEntry> legend_;
};

}  // namespace lfm
