// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "encode/model.h"

namespace lfm {

/// What of a model is evaluated.
struct EvaluationOptions {
  int terms = 1 << 20;  ///< at most this many terms; 0 = the mean view alone
  /// This term alone, from 0, over mid grey (over black where the terms hold the mean view, NMF):
  /// `terms` does not count then. Negative: none.
  int term_alone = -1;

  int FirstTerm() const { return std::max(term_alone, 0); }
  /// One behind the last.
  int EndOfTerms() const { return term_alone >= 0 ? term_alone + 1 : terms; }
};

/// The colour that a model shows: what a model *means*. The renderers call this, or are tested
/// against it.
///
/// `weights` are the barycentric weights of the surface point in `triangle` (clamped to it);
/// `to_eye` is the unit direction from that point to the eye, world frame. Surface maps are
/// interpolated bilinearly in the patch grid, and linearly in its cells on the hypotenuse: no jump
/// between triangles. The gutter texel b + c - a makes plain bilinear filtering of the pages the
/// same, but for the few places of a mean page where the code had to be clamped. View maps are
/// interpolated bilinearly with corner-aligned texels. Returns sRGB-coded RGB, clamped to [0, 1].
///
/// Needs a consistent model (from Encode or ReadGlb); about 100 ns a term and call.
Eigen::Vector3f EvaluateModel(const LightFieldModel& model, int triangle,
                              const Eigen::Vector3d& weights, const Eigen::Vector3d& to_eye,
                              const EvaluationOptions& options = {});
/// The same before it is clamped: below 0 and above 1 where the terms say so.
Eigen::Vector3f EvaluateUnclamped(const LightFieldModel& model, int triangle,
                                  const Eigen::Vector3d& weights, const Eigen::Vector3d& to_eye,
                                  const EvaluationOptions& options = {});

}  // namespace lfm
