// SPDX-License-Identifier: BSD-3-Clause
#include "calib/lens_choice.h"

#include <algorithm>
#include <array>

#include "calib/calib_picture.h"
#include "calib/corner_refinement.h"
#include "calib/picture_search.h"
#include "core/parallel.h"

namespace lfm {
namespace {

constexpr std::array<int, 5> kModels = {0, 1, 2, 4, 5};
constexpr size_t kFolds = 4;
constexpr size_t kMostViews = 16, kMostCorners = 100;
constexpr double kGain = 0.99;

// The corners from `first` on in steps of `step`.
BundleView Thin(const BundleView& view, size_t first, size_t step) {
  BundleView thin{view.camera_from_world, {}, {}};
  for (size_t i = first; i < view.points.size(); i += step) {
    thin.points.push_back(view.points[i]);
    thin.pixels.push_back(view.pixels[i]);
  }
  return thin;
}

std::vector<BundleView> Spread(const std::vector<BundleView>& all) {
  std::vector<BundleView> some;
  const size_t count = std::min(all.size(), kMostViews);
  for (size_t i = 0; i < count; ++i) {
    const BundleView& view = all[i * all.size() / count];
    some.push_back(Thin(view, 0, (view.points.size() + kMostCorners - 1) / kMostCorners));
  }
  return some;
}

double HeldOutError(const Camera& camera, const BundleView& view, double robust_scale_px) {
  BundleView judged = Thin(view, 1, 2);
  judged.camera_from_world = AdjustPose(camera, Thin(view, 0, 2), robust_scale_px);
  double sum = 0;
  const double most = robust_scale_px * robust_scale_px;
  for (const auto& error : ReprojectionErrors(camera, judged)) {
    sum += error ? std::min(most, error->squaredNorm()) : most;
  }
  return sum;
}

double FoldError(const Camera& start, const std::vector<BundleView>& views, size_t fold, int terms,
                 double robust_scale_px) {
  std::vector<BundleView> fitted;
  for (size_t i = 0; i < views.size(); ++i) {
    if (i % kFolds != fold) fitted.push_back(views[i]);
  }
  const Camera camera =
      AdjustBundle(KeepLensTerms(start, terms), fitted,
                   {.lens_terms = terms, .robust_scale_px = robust_scale_px, .max_iterations = 30})
          .camera;
  double sum = 0;
  for (size_t i = fold; i < views.size(); i += kFolds) {
    sum += HeldOutError(camera, views[i], robust_scale_px);
  }
  return sum;
}

}  // namespace

int ChooseLensTerms(const Camera& camera, const std::vector<BundleView>& views,
                    double robust_scale_px) {
  if (views.size() < kFolds) return kAllLensTerms;
  const std::vector<BundleView> some = Spread(views);
  std::array<double, kModels.size() * kFolds> errors;
  ParallelFor(0, static_cast<int64_t>(errors.size()), [&](int64_t i) {
    const auto task = static_cast<size_t>(i);
    errors[task] = FoldError(camera, some, task % kFolds, kModels[task / kFolds], robust_scale_px);
  });
  int best = 0;
  double best_error = 0;
  for (size_t model = 0; model < kModels.size(); ++model) {
    double error = 0;
    for (size_t fold = 0; fold < kFolds; ++fold) error += errors[model * kFolds + fold];
    if (model == 0 || error < kGain * best_error) {
      best_error = error;
      best = kModels[model];
    }
  }
  return best;
}

int ChooseLensTerms(const CameraAdjustment& adjustment, const std::string& camera_name,
                    const Board& board, const CalibOptions& options) {
  const std::vector<Eigen::Vector3d> corners = BoardCorners(board);
  std::vector<BundleView> views;
  for (const CalibPicture& picture : adjustment.pictures) {
    const bool used = picture.InUse() && picture.camera == camera_name &&
                      picture.split == PhotoSplit::kTrain && !picture.corners.empty();
    if (used) views.push_back(ViewOfCorners(picture, corners));
  }
  return ChooseLensTerms(adjustment.camera, views, options.robust_scale_px);
}

}  // namespace lfm
