// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calib/board.h"
#include "calib/bundle_adjustment.h"
#include "calib/calib.h"
#include "calib/camera_adjustment.h"

namespace lfm {

/// How many lens terms (KeepLensTerms: 0, 1, 2, 4 or 5) a camera needs: more enter only when they
/// lower the error of pictures kept out of the fit.
///
/// Cross-validation in four parts over at most 16 of `views` and 100 corners of each, spread
/// evenly: intrinsics and poses are adjusted to three parts; each picture of the fourth is then
/// posed by every other of its corners, the camera held, and the error of the rest counts (squared,
/// at most `robust_scale_px` each). A richer model must lower the sum by a hundredth at least: a
/// term that says nothing hardly ever does by chance, and what is left out moves corners by a tenth
/// of their noise. Fewer than four views cannot tell: all terms enter. `camera` and the poses of
/// `views` are where adjustments start. Does not depend on the number of threads.
int ChooseLensTerms(const Camera& camera, const std::vector<BundleView>& views,
                    double robust_scale_px);
/// The same from the refined corners of the training pictures of one camera.
int ChooseLensTerms(const CameraAdjustment& adjustment, const std::string& camera_name,
                    const Board& board, const CalibOptions& options);

}  // namespace lfm
