// SPDX-License-Identifier: BSD-3-Clause
// One ray a sample against the mesh, then encode/model_evaluation.h: no approximation of its own.
#include "viewer/reference_renderer.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "core/ray_scene.h"

namespace lfm {
namespace {

constexpr int kMaxSamplesPerSide = 16;

void ValidateOptions(const RenderOptions& options) {
  if (options.samples_per_side < 1 || options.samples_per_side > kMaxSamplesPerSide) {
    throw Error("supersampling is " + std::to_string(options.samples_per_side) +
                " rays a side; choose 1 to " + std::to_string(kMaxSamplesPerSide));
  }
  if (!options.background.allFinite() || options.background.minCoeff() < 0 ||
      options.background.maxCoeff() > 1) {
    throw Error("the background colour lies outside [0, 1]");
  }
}

void ValidatePose(const Pose& camera_from_world) {
  if (camera_from_world.rotation.allFinite() && camera_from_world.translation.allFinite()) return;
  throw Error("the pose of the camera to render is not finite");
}

Eigen::Vector3f LinearColor(const Eigen::Vector3f& coded) {
  return coded.unaryExpr([](float value) { return LinearFromSrgb(value); });
}

Eigen::Vector3f CodedColor(const Eigen::Vector3f& linear) {
  return linear.unaryExpr([](float value) { return SrgbFromLinear(value); });
}

uint8_t Code8(float value) {
  return static_cast<uint8_t>(std::lround(255.0f * std::clamp(value, 0.0f, 1.0f)));
}

/// What the rays of one pixel gathered. `coded` is the last hit's colour: a pixel of one sample
/// keeps it without a round trip through linear light.
struct PixelSum {
  int hits = 0;
  Eigen::Vector3f linear = Eigen::Vector3f::Zero();
  Eigen::Vector3f coded = Eigen::Vector3f::Zero();
};

struct View {
  const Camera& camera;
  Eigen::Matrix3d world_from_camera;
  Eigen::Vector3d eye;
};

PixelSum ShadePixel(const LightFieldModel& model, const RayScene& rays, const View& view,
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
      sum.coded = EvaluateModel(model, hit->triangle, weights, -direction, options.evaluation);
      if (n > 1) sum.linear += LinearColor(sum.coded);
      ++sum.hits;
    }
  }
  return sum;
}

void StorePixel(const PixelSum& sum, const RenderOptions& options, int x, int y,
                Rendering& rendering) {
  const int samples = options.samples_per_side * options.samples_per_side;
  const float share = static_cast<float>(sum.hits) / samples;
  Eigen::Vector3f over = options.background;
  Eigen::Vector3f alone = Eigen::Vector3f::Zero();
  if (samples == 1 && sum.hits == 1) {
    over = alone = sum.coded;
  } else if (sum.hits > 0) {
    alone = CodedColor(sum.linear / sum.hits);
    over = CodedColor(sum.linear / samples + (1 - share) * LinearColor(options.background));
  }
  for (int c = 0; c < 3; ++c) {
    rendering.color.At<uint8_t>(x, y, c) = Code8(over[c]);
    rendering.layer.At<uint8_t>(x, y, c) = Code8(alone[c]);
  }
  rendering.coverage.At<uint8_t>(x, y) = rendering.layer.At<uint8_t>(x, y, 3) = Code8(share);
}

}  // namespace

struct ReferenceRenderer::State {
  explicit State(LightFieldModel m) : model(std::move(m)), rays(model.mesh) {}
  LightFieldModel model;
  RayScene rays;
};

ReferenceRenderer::ReferenceRenderer(LightFieldModel model) {
  ValidateModel(model, "the model");
  state_ = std::make_unique<State>(std::move(model));
}
ReferenceRenderer::~ReferenceRenderer() = default;
ReferenceRenderer::ReferenceRenderer(ReferenceRenderer&&) noexcept = default;

const LightFieldModel& ReferenceRenderer::model() const { return state_->model; }

Rendering ReferenceRenderer::Render(const Camera& camera, const Pose& camera_from_world,
                                    const RenderOptions& options, Progress& progress) const {
  ValidateCamera(camera, "the camera to render");
  ValidatePose(camera_from_world);
  ValidateOptions(options);
  const int width = camera.width, height = camera.height;
  Rendering rendering{Image(width, height, 3, PixelType::kUint8, ColorEncoding::kSrgb),
                      Image(width, height, 1, PixelType::kUint8, ColorEncoding::kLinear),
                      Image(width, height, 4, PixelType::kUint8, ColorEncoding::kSrgb)};
  const View view{camera, camera_from_world.rotation.transpose(), camera_from_world.Center()};
  progress.Start("render", height);
  ParallelFor(0, height, [&](int64_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < width; ++x) {
      StorePixel(ShadePixel(state_->model, state_->rays, view, options, x, y), options, x, y,
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
