// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/gl_pictures.h"

#include <algorithm>

#include "core/error.h"
#include "core/parallel.h"
#include "viewer/egl_context.h"
#include "viewer/gl_framebuffer.h"
#include "viewer/gl_scene.h"
#include "viewer/pixel_sum.h"

namespace lfm {
namespace {

struct Tile {
  int x, y, width, height;  // pixels
};

/// The pinhole whose pixels are the samples of a tile: sample (i, j) of pixel (x, y) lies at
/// x - 1/2 + (i + 1/2) / n, as ReferenceRenderer has it.
Camera SampleCamera(const Camera& camera, const Tile& tile, int n) {
  Camera samples = camera;
  samples.width = tile.width * n;
  samples.height = tile.height * n;
  samples.fx = camera.fx * n;
  samples.fy = camera.fy * n;
  samples.cx = (camera.cx + 0.5 - tile.x) * n - 0.5;
  samples.cy = (camera.cy + 0.5 - tile.y) * n - 0.5;
  return samples;
}

void StoreTile(const Image& samples, const Tile& tile, const RenderOptions& options,
               Rendering& rendering) {
  const int n = options.samples_per_side;
  ParallelFor(0, tile.height, [&](int64_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < tile.width; ++x) {
      PixelSum sum;
      for (int k = 0; k < n * n; ++k) {
        const uint8_t* sample = &samples.At<uint8_t>(n * x + k % n, n * y + k / n);
        if (sample[3] == 0) continue;
        sum.Add(Eigen::Vector3f(sample[0], sample[1], sample[2]) / 255);
      }
      StorePixel(sum, options, tile.x + x, tile.y + y, rendering);
    }
  });
}

}  // namespace

struct GlPictures::State {
  State(const Scene& models, ViewCoordinates coordinates, int side)
      : scene(models, BlockUse::kAutomatic), view_coordinates(coordinates), tile_side(side) {}
  EglContext context;  // before what lives in it
  GlScene scene;
  ViewCoordinates view_coordinates;
  int tile_side;
};

GlPictures::GlPictures(const LightFieldModel& model, ViewCoordinates view_coordinates,
                       int tile_side)
    : GlPictures(SceneOf(model), view_coordinates, tile_side) {}

GlPictures::GlPictures(const Scene& scene, ViewCoordinates view_coordinates, int tile_side)
    : state_(std::make_unique<State>(scene, view_coordinates, tile_side)) {
  if (tile_side < 16) throw Error("tiles have 16 samples a side at least", ErrorKind::kSystem);
}
GlPictures::~GlPictures() = default;
GlPictures::GlPictures(GlPictures&&) noexcept = default;

Rendering GlPictures::Render(const Camera& camera, const Pose& camera_from_world,
                             const RenderOptions& options, Progress& progress) const {
  ValidateCamera(camera, "the camera to render");
  ValidateOptions(options);
  const int n = options.samples_per_side;
  const int side = std::max(1, state_->tile_side / n);
  Rendering rendering = EmptyRendering(camera.width, camera.height, options);
  GlRenderOptions gl_options;
  gl_options.evaluation = options.evaluation;
  gl_options.tone = options.tone;
  gl_options.view_coordinates = state_->view_coordinates;
  gl_options.background_alpha = 0;
  progress.Start("render", camera.height);
  for (int y = 0; y < camera.height; y += side) {
    const int height = std::min(side, camera.height - y);
    for (int x = 0; x < camera.width; x += side) {
      const Tile tile{x, y, std::min(side, camera.width - x), height};
      const Camera samples = SampleCamera(camera, tile, n);
      const GlFramebuffer framebuffer(samples.width, samples.height, 1);
      framebuffer.Bind();
      state_->scene.Draw(samples, camera_from_world, gl_options);
      StoreTile(framebuffer.Read(4), tile, options, rendering);
      progress.Advance(0);  // may be interrupted
    }
    progress.Advance(height);
  }
  return rendering;
}

}  // namespace lfm
