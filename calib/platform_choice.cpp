// SPDX-License-Identifier: BSD-3-Clause
#include "calib/platform_choice.h"

#include "calib/heldout_corners.h"
#include "core/parallel.h"

namespace lfm {
namespace {

// Normal equations are dense in these: a thousand take 8 MB a thread.
constexpr int kMostUnknowns = 1000;
// Corners that a coarse picture displaces alike in all views look like a print that is off: a
// platform is believed until a tenth of the squared error is at stake.
constexpr double kPlatformGain = 0.9;
constexpr size_t kLeastViews = 8, kMostViews = 16, kMostCorners = 400;

// The models up to corners that move; those are many unknowns and tried only where fewer helped.
// A bend is one surface through the origin: boards attached to the platform are no part of it.
std::vector<PlatformModel> FirstModels(const Board& board) {
  if (!board.attached.empty())
    return {{PlatformMoves::kNone, false}, {PlatformMoves::kTags, false}};
  return {{PlatformMoves::kNone, false},
          {PlatformMoves::kNone, true},
          {PlatformMoves::kTags, false},
          {PlatformMoves::kTags, true}};
}
std::vector<PlatformModel> LastModels(const Board& board) {
  if (!board.attached.empty()) return {{PlatformMoves::kCorners, false}};
  return {{PlatformMoves::kCorners, false}, {PlatformMoves::kCorners, true}};
}

/// Tries `models` on a bundle, appends the trials, and keeps the best so far.
class PlatformContest {
 public:
  PlatformContest(const Board& board, const JointBundle& bundle, double prior_mm, double noise_px,
                  double robust_scale_px)
      : board_(board),
        bundle_(bundle),
        prior_mm_(prior_mm),
        noise_px_(noise_px),
        robust_scale_px_(robust_scale_px) {}

  void Try(std::vector<PlatformModel> models) {
    std::erase_if(models, [&](const PlatformModel& model) {
      return MakePlatformUnknowns(board_, model).Count() > kMostUnknowns;
    });
    std::vector<double> errors(models.size());
    ParallelFor(0, static_cast<int64_t>(models.size()), [&](int64_t i) {
      JointBundle tried = bundle_;
      tried.platform = MakePlatformUnknowns(board_, models[i]);
      tried.platform->prior_mm = prior_mm_;
      tried.platform->noise_px = noise_px_;
      errors[i] = HeldoutRms(tried, robust_scale_px_);
    });
    for (size_t i = 0; i < models.size(); ++i) {
      const double ratio = errors[i] / best_error_;
      if (choice.trials.empty() || ratio * ratio < kPlatformGain) {
        choice.model = models[i];
        best_error_ = errors[i];
      }
      choice.trials.push_back({PlatformModelName(models[i]), errors[i]});
    }
  }

  PlatformChoice choice;

 private:
  const Board& board_;
  const JointBundle& bundle_;
  double prior_mm_, noise_px_, robust_scale_px_, best_error_ = 0;
};

}  // namespace

PlatformChoice ChoosePlatform(const Board& board, const JointBundle& bundle, double prior_mm,
                              double noise_px, double robust_scale_px) {
  const JointBundle some = SpreadBundle(bundle, kMostViews, kMostCorners);
  if (some.views.size() < kLeastViews) return {};
  PlatformContest contest(board, some, prior_mm, noise_px, robust_scale_px);
  contest.Try(FirstModels(board));
  if (contest.choice.model.moves == PlatformMoves::kTags) contest.Try(LastModels(board));
  return contest.choice;
}

}  // namespace lfm
