// SPDX-License-Identifier: BSD-3-Clause
#include "calib/lens_choice.h"

#include <algorithm>
#include <array>

#include "calib/heldout_corners.h"
#include "core/parallel.h"

namespace lfm {
namespace {

constexpr std::array<int, 6> kModels = {0, 1, 2, 4, 5, 8};
// Terms that come by the half dozen lower the error a little by chance.
constexpr double kGainOfATerm = 0.005;
constexpr size_t kMostViews = 16, kMostCorners = 100;

}  // namespace

std::string LensModelName(int terms) {
  std::string name;
  for (int i = 0; i < terms; ++i) {
    name += std::string(i > 0 ? " " : "") + kIntrinsicNames[kFirstLensTerm + i];
  }
  return terms > 0 ? name : "none";
}

bool IsLensModel(int terms) {
  return std::find(kModels.begin(), kModels.end(), terms) != kModels.end();
}

LensChoice ChooseLensTerms(const Camera& camera, const std::vector<BundleView>& views,
                           double robust_scale_px) {
  LensChoice choice;
  JointBundle all{{{camera}}, views};
  for (BundleView& view : all.views) view.camera = 0;
  const JointBundle some = SpreadBundle(all, kMostViews, kMostCorners);
  if (some.views.empty()) choice.terms = 1;
  if (some.views.size() < kHeldoutParts) return choice;
  choice.trials.resize(kModels.size());
  ParallelFor(0, static_cast<int64_t>(kModels.size()), [&](int64_t i) {
    JointBundle bundle = some;
    bundle.cameras[0] = {KeepLensTerms(camera, kModels[i]), FreeIntrinsics::kAll, kModels[i]};
    choice.trials[i] = {kModels[i], HeldoutRms(bundle, robust_scale_px, FoldingLens::kNoModel)};
  });
  LensTrial best = choice.trials[0];
  for (const LensTrial& trial : choice.trials) {
    const double ratio = trial.heldout_rms_px / best.heldout_rms_px;
    const double gain = std::min(kHeldoutGain, 1 - kGainOfATerm * (trial.terms - best.terms));
    if (ratio * ratio < gain) best = trial;
  }
  choice.terms = best.terms;
  return choice;
}

}  // namespace lfm
