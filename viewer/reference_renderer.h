// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "core/camera.h"
#include "core/image.h"
#include "core/pose.h"
#include "core/progress.h"
#include "encode/model.h"
#include "encode/model_evaluation.h"

namespace lfm {

struct RenderOptions {
  EvaluationOptions evaluation;
  int samples_per_side = 1;                ///< supersampling: this many squared rays a pixel
  Eigen::Vector3f background = {0, 0, 0};  ///< sRGB-coded
};

/// A rendered view.
struct Rendering {
  Image color;     ///< 8-bit sRGB RGB, over the background
  Image coverage;  ///< 8-bit, one channel: share of the pixel's rays that hit the model
};

/// Defines what a model looks like: one Embree ray a sample through the camera's full lens model,
/// exact evaluation (encode/model_evaluation.h), view direction a pixel.
class ReferenceRenderer {
 public:
  explicit ReferenceRenderer(LightFieldModel model);
  ~ReferenceRenderer();
  ReferenceRenderer(ReferenceRenderer&&) noexcept;
  const LightFieldModel& model() const;
  Rendering Render(const Camera& camera, const Pose& camera_from_world,
                   const RenderOptions& options, Progress& progress) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// 8-bit mask, one channel, 255 where the ray through a pixel's centre hits the mesh.
Image RenderSilhouette(const TriangleMesh& mesh, const Camera& camera,
                       const Pose& camera_from_world);

}  // namespace lfm
