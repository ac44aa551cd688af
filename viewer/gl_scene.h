// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "viewer/gl_renderer.h"
#include "viewer/scene.h"

namespace lfm {

/// Draws a scene's models into one picture. Needs a current context, the same one for its whole
/// life.
class GlScene {
 public:
  GlScene() = default;
  /// Uploads all models; they are not needed afterwards. Throws Error as GlRenderer does.
  explicit GlScene(const Scene& scene, BlockUse block_use = BlockUse::kAsTheyAre);

  /// Uploads a model, unless it is there in another place, and shows it in the place of number
  /// `index`, or, at size(), as one more.
  void Put(size_t index, const PlacedModel& model, BlockUse block_use);
  /// Moves one that is there.
  void Place(size_t index, const Placement& placement) { models_.at(index).placement = placement; }
  size_t size() const { return models_.size(); }
  /// Round all models, in the world; a unit sphere round the origin without any.
  Sphere bounds() const;

  /// Clears the bound framebuffer, whose viewport is camera.width x camera.height, and draws.
  /// Throws Error when the camera has lens distortion.
  void Draw(const Camera& camera, const Pose& camera_from_world,
            const GlRenderOptions& options) const;
  /// Draws to what is there already.
  void DrawInto(const GlView& view, const GlRenderOptions& options) const;
  /// How often a draw goes over a mesh.
  int PassCount(const GlRenderOptions& options) const;

 private:
  struct Item {
    std::weak_ptr<const LightFieldModel> model;
    std::shared_ptr<const GlRenderer> renderer;  ///< of all places where the model stands
    Placement placement;
  };
  std::vector<Item> models_;
};

}  // namespace lfm
