// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calib/bundle_adjustment.h"
#include "calib/model_trials.h"

namespace lfm {

struct LensChoice {
  int terms = kBrownLensTerms;
  std::vector<LensTrial> trials;  ///< with 0, 1, 2, 4, 5 and 8 terms; none when there is no telling
};

/// How many lens terms (KeepLensTerms) a camera needs: more enter only when they lower the squared
/// error on corners kept out of the fit (heldout_corners.h) by a hundredth, and by half of that a
/// term, over at most 16 of `views` and 100 corners of each. Fewer than four views cannot tell:
/// Brown's five enter, or k1 alone where views have fewer than 12 corners each. `camera` and the
/// poses of `views` are where adjustments start. Does not depend on the number of threads.
LensChoice ChooseLensTerms(const Camera& camera, const std::vector<BundleView>& views,
                           double robust_scale_px);

}  // namespace lfm
