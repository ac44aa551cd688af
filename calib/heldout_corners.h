// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calib/bundle_adjustment.h"

namespace lfm {

/// Fewer views than this cannot be parted into what is fitted and what is judged.
inline constexpr int kHeldoutParts = 4;
/// Nor can the corners of a view with fewer than this; such views are left out.
inline constexpr size_t kHeldoutLeastCorners = 12;
/// A richer model must lower the squared error by a hundredth at least: an unknown that says
/// nothing hardly ever does by chance, and what is left out moves corners by a tenth of their
/// noise.
inline constexpr double kHeldoutGain = 0.99;

/// At most `most_views` of a bundle's views that have enough corners, and `most_corners` of each,
/// spread evenly.
JointBundle SpreadBundle(const JointBundle& bundle, size_t most_views, size_t most_corners);

/// How well a model explains corners kept out of its fit, by cross-validation in four parts:
/// cameras, platform and poses are adjusted to three parts of the views; each view of the fourth is
/// then posed by every other of its corners, all else held, and the error of the rest counts
/// (squared, at most `robust_scale_px` each, by the corners' weights). Returns sqrt(mean(dx^2 +
/// dy^2)), px; 0 when nothing
/// was kept out; infinity, with kNoModel, when a fitted camera folds over inside its picture.
enum class FoldingLens { kAllowed, kNoModel };
double HeldoutRms(const JointBundle& bundle, double robust_scale_px,
                  FoldingLens folding = FoldingLens::kAllowed);

}  // namespace lfm
