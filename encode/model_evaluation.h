// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "encode/model.h"

namespace lfm {

/// What of a model is evaluated.
struct EvaluationOptions {
  int terms = 1 << 20;  ///< at most this many terms; 0 = the mean view alone
};

/// The colour that a model shows: what a model *means*. The renderers call this, or are tested
/// against it.
///
/// `weights` are the barycentric weights of the surface point in `triangle`; `to_eye` is the unit
/// direction from that point to the eye, world frame. Surface maps are interpolated bilinearly in
/// the patch grid (gutter texels make that linear along every edge: no jump between triangles),
/// view maps bilinearly with corner-aligned texels. Returns sRGB-coded RGB, clamped to [0, 1].
Eigen::Vector3f EvaluateModel(const LightFieldModel& model, int triangle,
                              const Eigen::Vector3d& weights, const Eigen::Vector3d& to_eye,
                              const EvaluationOptions& options = {});

}  // namespace lfm
