// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/scene_overlay.h"

#include <algorithm>

namespace lfm {
namespace {

// What is counted, of all models: equal colours mean equal counts.
std::vector<int> CountsOf(const Scene& scene, Overlay overlay) {
  std::vector<int> counts;
  for (const PlacedModel& placed : scene) {
    if (overlay == Overlay::kTerms) {
      const std::vector<int>& terms = placed.model->vertex_terms;
      counts.insert(counts.end(), terms.begin(), terms.end());
    } else if (overlay == Overlay::kPatchSizes) {
      for (const PatchPlacement& patch : placed.model->placements) {
        counts.push_back(patch.edge_samples);
      }
    }
  }
  return counts;
}

}  // namespace

void SceneOverlay::DrawInto(const GlView& view, const Scene& scene, Overlay overlay,
                            EdgeOverlay edges,
                            const std::function<std::vector<int>()>& count_photographs) {
  const Eigen::Vector3d eye = view.camera_from_world.Center();
  if (models_.size() != scene.size()) {
    models_.clear();
    photographs_.clear();
    for (const PlacedModel& placed : scene) models_.emplace_back(placed.model->mesh);
    shown_ = Overlay::kNone;
  }
  if (shown_ != overlay || (DependsOnEye(overlay) && eye_ != eye)) {
    Color(scene, overlay, eye, count_photographs);
  }
  for (size_t i = 0; i < scene.size(); ++i) {
    models_[i].DrawInto(view, scene[i].placement, edges);
  }
  shown_ = overlay;
  eye_ = eye;
}

void SceneOverlay::Color(const Scene& scene, Overlay overlay, const Eigen::Vector3d& eye,
                         const std::function<std::vector<int>()>& count_photographs) {
  if (overlay == Overlay::kPhotographs && photographs_.empty()) {
    photographs_ = count_photographs();
  }
  legend_.clear();
  OverlayData data;
  data.all_counts = CountsOf(scene, overlay);
  for (size_t i = 0; i < scene.size(); ++i) {
    const Placement& placement = scene[i].placement;
    data.photographs = i == 0 ? photographs_ : std::vector<int>();
    data.eye = placement.world_from_model.Inverse() * eye / placement.scale;
    const OverlayColors colors = ColorsOf(overlay, *scene[i].model, data);
    models_[i].SetColors(colors.corners);
    for (const LegendEntry& entry : colors.legend) {
      const bool known = std::any_of(legend_.begin(), legend_.end(), [&](const LegendEntry& other) {
        return other.text == entry.text;
      });
      if (!known) legend_.push_back(entry);
    }
  }
}

}  // namespace lfm
