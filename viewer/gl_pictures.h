// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "viewer/gl_renderer.h"
#include "viewer/reference_renderer.h"

namespace lfm {

/// What OpenGL draws without a display, as ReferenceRenderer::Render gives it: the same samples in
/// the same places, averaged in linear light, of pictures of any size, drawn by tiles. Uses an
/// EglContext of its own: one at a time, on the thread that made it.
class GlPictures {
 public:
  static constexpr int kTileSide = 2048;  ///< samples

  /// Throws Error as EglContext and GlRenderer do. `tile_side`: samples, at least 16.
  explicit GlPictures(const LightFieldModel& model,
                      ViewCoordinates view_coordinates = ViewCoordinates::kPerPixel,
                      int tile_side = kTileSide);
  /// Several models, each where it stands.
  explicit GlPictures(const Scene& scene,
                      ViewCoordinates view_coordinates = ViewCoordinates::kPerPixel,
                      int tile_side = kTileSide);
  ~GlPictures();
  GlPictures(GlPictures&&) noexcept;

  /// Throws Error when the camera's lens distorts (a rasteriser draws pinhole pictures only), or
  /// camera or options are out of range.
  Rendering Render(const Camera& camera, const Pose& camera_from_world,
                   const RenderOptions& options, Progress& progress) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lfm
