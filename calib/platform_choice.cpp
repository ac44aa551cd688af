// SPDX-License-Identifier: BSD-3-Clause
#include "calib/platform_choice.h"

#include "calib/heldout_corners.h"
#include "core/parallel.h"

namespace lfm {
namespace {

// Corners that a coarse picture displaces alike in all views look like a print that is off: a
// platform is believed until a tenth of the squared error is at stake.
constexpr double kPlatformGain = 0.9;
constexpr size_t kLeastViews = 8, kMostViews = 16, kMostCorners = 400;

std::vector<PlatformModel> ModelsOf(const Board& board) {
  std::vector<PlatformModel> models;
  for (const PlatformMoves moves :
       {PlatformMoves::kNone, PlatformMoves::kTags, PlatformMoves::kCorners}) {
    // One tag alone has nothing to move against.
    const bool alone = board.tags.size() == 1 && board.CheckerCorners().empty();
    if (alone && moves == PlatformMoves::kTags) continue;
    models.push_back({moves, false});
    models.push_back({moves, true});
  }
  return models;
}

}  // namespace

PlatformChoice ChoosePlatform(const Board& board, const JointBundle& bundle, double prior_mm,
                              double noise_px, double robust_scale_px) {
  PlatformChoice choice;
  const JointBundle some = SpreadBundle(bundle, kMostViews, kMostCorners);
  if (some.views.size() < kLeastViews) return choice;
  const std::vector<PlatformModel> models = ModelsOf(board);
  choice.trials.resize(models.size());
  ParallelFor(0, static_cast<int64_t>(models.size()), [&](int64_t i) {
    JointBundle tried = some;
    tried.platform = MakePlatformUnknowns(board, models[i]);
    tried.platform->prior_mm = prior_mm;
    tried.platform->noise_px = noise_px;
    choice.trials[i] = {PlatformModelName(models[i]), HeldoutRms(tried, robust_scale_px)};
  });
  size_t best = 0;
  for (size_t i = 1; i < models.size(); ++i) {
    const double ratio = choice.trials[i].heldout_rms_px / choice.trials[best].heldout_rms_px;
    if (ratio * ratio < kPlatformGain) best = i;
  }
  choice.model = models[best];
  return choice;
}

}  // namespace lfm
