// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/gl_scene.h"

#include <utility>

namespace lfm {

GlScene::GlScene(const Scene& scene, BlockUse block_use) {
  for (const PlacedModel& model : scene) Put(size(), model, block_use);
}

void GlScene::Put(size_t index, const PlacedModel& model, BlockUse block_use) {
  Item item{model.model, nullptr, model.placement};
  for (const Item& other : models_) {
    if (other.model.lock() == model.model) item.renderer = other.renderer;
  }
  if (!item.renderer) item.renderer = std::make_shared<const GlRenderer>(*model.model, block_use);
  if (index < models_.size()) {
    std::swap(models_[index], item);
  } else {
    models_.push_back(std::move(item));
  }
}

Sphere GlScene::bounds() const {
  if (models_.empty()) return {};
  Sphere sphere = models_[0].placement * models_[0].renderer->bounds();
  for (const Item& item : models_) {
    sphere = SphereAround(sphere, item.placement * item.renderer->bounds());
  }
  return sphere;
}

void GlScene::Draw(const Camera& camera, const Pose& camera_from_world,
                   const GlRenderOptions& options) const {
  const GlView view = ViewOf(bounds(), camera, camera_from_world);
  ClearPicture(options.background, options.background_alpha);
  DrawInto(view, options);
}

void GlScene::DrawInto(const GlView& view, const GlRenderOptions& options) const {
  for (const Item& item : models_) item.renderer->DrawInto(view, item.placement, options);
}

int GlScene::PassCount(const GlRenderOptions& options) const {
  int passes = 0;
  for (const Item& item : models_) passes += item.renderer->PassCount(options);
  return passes;
}

}  // namespace lfm
