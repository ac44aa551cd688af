// SPDX-License-Identifier: BSD-3-Clause
// One ray a sample against the mesh, then encode/model_evaluation.h: no approximation of its own.
#include "viewer/reference_renderer.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "core/ray_scene.h"
#include "viewer/pixel_sum.h"

namespace lfm {
namespace {

void ValidatePose(const Pose& camera_from_world) {
  if (camera_from_world.rotation.allFinite() && camera_from_world.translation.allFinite()) return;
  throw Error("the pose of the camera to render is not finite");
}

struct View {
  const Camera& camera;
  Eigen::Matrix3d world_from_camera;
  Eigen::Vector3d eye;
};

// A model as rays meet it.
struct RayModel {
  std::shared_ptr<const LightFieldModel> model;
  Eigen::Matrix3d model_from_world;  ///< directions
  int first_triangle = 0;            ///< of all models' triangles
};

// The model that triangle `t` of all belongs to.
const RayModel& ModelOf(const std::vector<RayModel>& models, int t) {
  const auto behind = std::upper_bound(
      models.begin() + 1, models.end(), t,
      [](int triangle, const RayModel& model) { return triangle < model.first_triangle; });
  return *(behind - 1);
}

PixelSum ShadePixel(const std::vector<RayModel>& models, const RayScene& rays, const View& view,
                    const RenderOptions& options, int x, int y) {
  const int n = options.samples_per_side;
  PixelSum sum;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const Eigen::Vector2d pixel(x - 0.5 + (i + 0.5) / n, y - 0.5 + (j + 0.5) / n);
      const std::optional<Eigen::Vector3d> in_camera = TryUnproject(view.camera, pixel);
      if (!in_camera) continue;
      const Eigen::Vector3d direction = (view.world_from_camera * *in_camera).normalized();
      const std::optional<RayHit> hit = rays.Intersect(view.eye, direction);
      if (!hit) continue;
      const Eigen::Vector3d weights(1 - hit->u - hit->v, hit->u, hit->v);
      const RayModel& seen = ModelOf(models, hit->triangle);
      const Eigen::Vector3f color =
          EvaluateUnclamped(*seen.model, hit->triangle - seen.first_triangle, weights,
                            -(seen.model_from_world * direction), options.evaluation);
      sum.Add(ApplyTone(options.tone, color));
    }
  }
  return sum;
}

}  // namespace

struct ReferenceRenderer::State {
  explicit State(const Scene& scene) : rays(SceneMesh(scene)) {
    int triangles = 0;
    for (const PlacedModel& placed : scene) {
      models.push_back(
          {placed.model, placed.placement.world_from_model.rotation.transpose(), triangles});
      triangles += static_cast<int>(placed.model->mesh.triangles.size());
    }
  }
  std::vector<RayModel> models;
  RayScene rays;
};

ReferenceRenderer::ReferenceRenderer(LightFieldModel model)
    : ReferenceRenderer(
          Scene{{"the model", std::make_shared<const LightFieldModel>(std::move(model)), {}}}) {}

ReferenceRenderer::ReferenceRenderer(Scene scene) {
  if (scene.empty()) throw Error("there is nothing to render: the scene has no model");
  for (const PlacedModel& placed : scene) ValidateModel(*placed.model, placed.name);
  state_ = std::make_unique<State>(scene);
}
ReferenceRenderer::~ReferenceRenderer() = default;
ReferenceRenderer::ReferenceRenderer(ReferenceRenderer&&) noexcept = default;

const LightFieldModel& ReferenceRenderer::model() const { return *state_->models.front().model; }

Rendering ReferenceRenderer::Render(const Camera& camera, const Pose& camera_from_world,
                                    const RenderOptions& options, Progress& progress) const {
  ValidateCamera(camera, "the camera to render");
  ValidatePose(camera_from_world);
  ValidateOptions(options);
  const int width = camera.width, height = camera.height;
  Rendering rendering = EmptyRendering(width, height, options);
  const View view{camera, camera_from_world.rotation.transpose(), camera_from_world.Center()};
  progress.Start("render", height);
  ParallelFor(0, height, [&](int64_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < width; ++x) {
      StorePixel(ShadePixel(state_->models, state_->rays, view, options, x, y), options, x, y,
                 rendering);
    }
    progress.Advance();
  });
  return rendering;
}

Image RenderSilhouette(const TriangleMesh& mesh, const Camera& camera,
                       const Pose& camera_from_world) {
  ValidateMesh(mesh, "the silhouette");
  return RenderSilhouette(RayScene(mesh), camera, camera_from_world);
}

Image RenderSilhouette(const RayScene& rays, const Camera& camera, const Pose& camera_from_world) {
  ValidateCamera(camera, "the camera of the silhouette");
  ValidatePose(camera_from_world);
  Image mask(camera.width, camera.height, 1, PixelType::kUint8, ColorEncoding::kLinear);
  const Eigen::Matrix3d world_from_camera = camera_from_world.rotation.transpose();
  const Eigen::Vector3d eye = camera_from_world.Center();
  ParallelFor(0, camera.height, [&](int64_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < camera.width; ++x) {
      const std::optional<Eigen::Vector3d> direction = TryUnproject(camera, {x, y});
      if (!direction) continue;
      if (rays.Intersect(eye, world_from_camera * *direction)) mask.At<uint8_t>(x, y) = 255;
    }
  });
  return mask;
}

}  // namespace lfm
