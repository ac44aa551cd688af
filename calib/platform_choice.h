// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calib/bundle_adjustment.h"
#include "calib/model_trials.h"
#include "calib/platform_shape.h"

namespace lfm {

struct PlatformChoice {
  PlatformModel model;
  std::vector<PlatformTrial> trials;  ///< none when there is no telling
};

/// Whether the platform is as its file says, is bent, has tags (or corners) that lie elsewhere:
/// more enters only when it lowers the squared error on corners kept out of the fit by a tenth
/// (heldout_corners.h), over at most 16 views. Fewer than eight views cannot tell a platform from a
/// lens: it is as printed. Corners that move are tried only where tags that move helped. `bundle`
/// names the corners of its views and holds no platform yet.
PlatformChoice ChoosePlatform(const Board& board, const JointBundle& bundle, double prior_mm,
                              double noise_px, double robust_scale_px);

}  // namespace lfm
