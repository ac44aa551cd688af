// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "core/camera.h"
#include "core/image.h"
#include "core/pose.h"
#include "core/progress.h"
#include "encode/model.h"
#include "encode/model_evaluation.h"
#include "viewer/scene.h"
#include "viewer/tone.h"

namespace lfm {

class RayScene;

struct RenderOptions {
  EvaluationOptions evaluation;
  Tone tone;                               ///< before samples are averaged
  int samples_per_side = 1;                ///< supersampling: this many squared rays a pixel, 1-16
  Eigen::Vector3f background = {0, 0, 0};  ///< sRGB-coded, [0, 1]
  bool linear_light = false;               ///< the pictures in linear light too
};

/// A rendered view.
struct Rendering {
  Image color;     ///< 8-bit sRGB RGB, over the background
  Image coverage;  ///< 8-bit, one channel: share of the pixel's rays that hit the model
  /// 8-bit sRGB RGBA: the model alone, straight alpha = coverage; (0, 0, 0, 0) where nothing is
  /// hit.
  Image layer;
  /// With linear_light, float: RGB over the background; RGBA of the model alone, associated alpha
  /// (colours times coverage), as EXR files have it. Else empty.
  Image linear_color, linear_layer;
};

/// Defines what a model looks like: one Embree ray a sample through the camera's full lens model,
/// exact evaluation (encode/model_evaluation.h), view direction a sample.
///
/// With samples_per_side = n, the n x n rays of pixel (x, y) go through
/// (x - 1/2 + (i + 1/2) / n, y - 1/2 + (j + 1/2) / n); one ray goes through the centre. Samples,
/// and the model and the background at silhouettes, are averaged in linear light, as a sensor does.
/// Surfaces are shown from both sides. A picture without a hit is all background.
class ReferenceRenderer {
 public:
  /// Throws Error when the model's mesh has no triangle or its tables do not fit each other.
  explicit ReferenceRenderer(LightFieldModel model);
  /// Several models, each where it stands; the nearest is seen. Throws Error as above, and without
  /// any model.
  explicit ReferenceRenderer(Scene scene);
  ~ReferenceRenderer();
  ReferenceRenderer(ReferenceRenderer&&) noexcept;
  const LightFieldModel& model() const;  ///< the first
  /// Parallel over rows; the bytes do not depend on the number of threads. A ray at which
  /// the lens model folds back sees nothing. Throws Error when the camera or the options are out of
  /// range.
  Rendering Render(const Camera& camera, const Pose& camera_from_world,
                   const RenderOptions& options, Progress& progress) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// 8-bit mask, one channel, 255 where the ray through a pixel's centre hits the mesh; 0 where the
/// lens model folds back. Throws Error when the camera is invalid or the mesh has no triangle.
Image RenderSilhouette(const TriangleMesh& mesh, const Camera& camera,
                       const Pose& camera_from_world);
/// The same of a mesh prepared once for many cameras.
Image RenderSilhouette(const RayScene& rays, const Camera& camera, const Pose& camera_from_world);

}  // namespace lfm
