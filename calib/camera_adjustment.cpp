// SPDX-License-Identifier: BSD-3-Clause
#include "calib/camera_adjustment.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "calib/camera_start.h"
#include "calib/picture_search.h"
#include "core/error.h"

namespace lfm {
namespace {

constexpr double kMaxFocalError = 0.02, kMaxCenterError = 0.02;
constexpr double kOutlierSigmas = 4.5;
constexpr int kMaxIterations = 100;
// A picture's own noise counts as so many residuals of all pictures' noise.
constexpr double kSharedFreedom = 40;
// Exact corners would make anything look certain. Below what the best of the tests' pictures reach
// (0.002 px): not a statement about them.
constexpr double kLeastNoisePx = 0.001;
// Views this close (of their distance to the corners, and in radians) are from one place.
constexpr double kSamePlace = 0.002;

std::string Rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  return text;
}

double RobustSigma(const std::vector<std::optional<Eigen::Vector2d>>& errors) {
  std::vector<double> magnitudes;
  for (const auto& error : errors) {
    if (!error) continue;
    magnitudes.push_back(std::abs(error->x()));
    magnitudes.push_back(std::abs(error->y()));
  }
  if (magnitudes.empty()) return 0;
  const auto middle = magnitudes.begin() + static_cast<std::ptrdiff_t>(magnitudes.size() / 2);
  std::nth_element(magnitudes.begin(), middle, magnitudes.end());
  return 1.4826 * *middle;
}

std::vector<size_t> InUse(const Adjustment& adjustment, PhotoSplit split) {
  std::vector<size_t> selected;
  for (size_t i = 0; i < adjustment.pictures.size(); ++i) {
    const CalibPicture& picture = adjustment.pictures[i];
    if (picture.InUse() && picture.split == split) selected.push_back(i);
  }
  return selected;
}

Eigen::Vector3d MeanOf(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d sum(0, 0, 0);
  for (const Eigen::Vector3d& point : points) sum += point;
  return sum / std::max(1.0, static_cast<double>(points.size()));
}

// How many of the views were taken from a view's place.
std::vector<double> CountRepeats(const std::vector<BundleView>& views) {
  std::vector<double> counts(views.size());
  for (size_t a = 0; a < views.size(); ++a) {
    const Pose& pose = views[a].camera_from_world;
    const double near_mm = kSamePlace * (pose.Center() - MeanOf(views[a].points)).norm();
    for (const BundleView& other : views) {
      const Pose& there = other.camera_from_world;
      counts[a] += other.camera == views[a].camera &&
                   (pose.Center() - there.Center()).norm() < near_mm &&
                   RotationAngle(pose.rotation, there.rotation) < kSamePlace;
    }
  }
  return counts;
}

// Keeps the corners that a picture's own noise explains, then judges what is left.
CalibPicture DropOutliers(CalibPicture picture, const Camera& camera,
                          const std::vector<Eigen::Vector3d>& corners, double common_sigma_px,
                          int least_corners, const CalibOptions& options) {
  const auto errors = ReprojectionErrors(camera, ViewOfCorners(picture, corners));
  const double limit = kOutlierSigmas * std::max(common_sigma_px, RobustSigma(errors)) + 1e-9;
  std::vector<CornerObservation> kept;
  double squared = 0;
  for (size_t i = 0; i < errors.size(); ++i) {
    if (!errors[i] || errors[i]->norm() > limit) continue;
    kept.push_back(picture.corners[i]);
    squared += errors[i]->squaredNorm();
  }
  const double rms = kept.empty() ? 0 : std::sqrt(squared / static_cast<double>(kept.size()));
  if (static_cast<int>(kept.size()) < least_corners) {
    picture.rejected = "only " + std::to_string(kept.size()) + " of " +
                       std::to_string(errors.size()) + " corners agree with one pose, at least " +
                       std::to_string(least_corners) + " are needed";
  } else if (rms > options.max_reprojection_px) {
    picture.rejected = "its corners fit to " + Rounded(rms) + " px only, more than " +
                       Rounded(options.max_reprojection_px) +
                       " px; another board, or one that is not flat?";
  }
  picture.corners = std::move(kept);
  return picture;
}

// Sum over pairs of corners near enough to be measured on the same pixels: of the products of their
// weighed errors, both ways.
double SharedErrors(const BundleView& view,
                    const std::vector<std::optional<Eigen::Vector2d>>& errors) {
  constexpr double kWindowPx = 2 * CornerSearch().window_radius_px + 1;
  std::vector<Eigen::Vector2d> weighed(errors.size(), {0, 0});
  for (size_t i = 0; i < errors.size(); ++i) {
    // Of unit variance: the products are those whose sum over one corner is SquareOf.
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> weight(view.WeightOf(i));
    if (errors[i]) weighed[i] = weight.operatorSqrt() * *errors[i];
  }
  double sum = 0;
  for (size_t i = 0; i < errors.size(); ++i) {
    for (size_t j = 0; errors[i] && j < i; ++j) {
      if (!errors[j] || (view.pixels[i] - view.pixels[j]).norm() > kWindowPx) continue;
      sum += 2 * weighed[i].dot(weighed[j]);
    }
  }
  return sum;
}

// The standard deviation of each picture's corners of weight 1, drawn towards that of all pictures
// of its camera: what was fitted is subtracted from the freedom, a share of the intrinsics a
// picture; what neighbouring corners have in common counts beside.
void EstimateNoise(Adjustment& adjustment, const Board& board, PhotoSplit split) {
  const std::vector<Eigen::Vector3d> corners =
      CornerPositions(BoardCorners(board), adjustment.shape);
  for (const auto& [name, camera] : adjustment.cameras) {
    const std::vector<size_t> selected = SelectPictures(adjustment.pictures, name, split);
    double shared = 0, squared = 0,
           freedom = camera.known || split == PhotoSplit::kTest
                         ? 0
                         : -(kFirstLensTerm + camera.lens_terms);
    std::vector<std::pair<double, double>> of_picture;
    for (const size_t i : selected) {
      std::pair<double, double> own(0, -6);
      const BundleView view = ViewOfCorners(adjustment.pictures[i], corners);
      const auto errors = ReprojectionErrors(camera.camera, view);
      for (size_t k = 0; k < errors.size(); ++k) {
        if (!errors[k]) continue;
        own.first += view.SquareOf(k, *errors[k]);
        own.second += 2;
      }
      shared += SharedErrors(view, errors);
      squared += own.first, freedom += own.second;
      of_picture.push_back(own);
    }
    const double common = freedom > 0 ? squared / freedom : 0;
    // What a smooth model makes of errors is their variance and what they share with those beside.
    const double raised = squared > 0 ? 1 + std::max(0.0, shared / squared) : 1;
    for (size_t k = 0; k < selected.size(); ++k) {
      const auto& [own_squared, own_freedom] = of_picture[k];
      const double variance =
          (own_squared + kSharedFreedom * common) / (std::max(0.0, own_freedom) + kSharedFreedom);
      adjustment.pictures[selected[k]].noise_px = std::sqrt(raised * variance);
    }
  }
}

}  // namespace

int LeastCorners(const Board& board, const CalibOptions& options) {
  return std::min(options.min_corners, static_cast<int>(BoardCorners(board).size()));
}

AdjustmentBundle BundleOf(const Adjustment& adjustment, const Board& board, PhotoSplit split,
                          const CalibOptions& options) {
  AdjustmentBundle all;
  std::map<std::string, int> index;
  for (const auto& [name, camera] : adjustment.cameras) {
    index[name] = static_cast<int>(all.bundle.cameras.size());
    all.bundle.cameras.push_back(
        {camera.known ? camera.camera : KeepLensTerms(camera.camera, camera.lens_terms),
         camera.known ? FreeIntrinsics::kNone : FreeIntrinsics::kAll, camera.lens_terms});
  }
  const std::vector<Eigen::Vector3d> corners =
      CornerPositions(BoardCorners(board), adjustment.shape);
  all.pictures = InUse(adjustment, split);
  double squared = 0, count = 0;
  for (const size_t i : all.pictures) {
    const CalibPicture& picture = adjustment.pictures[i];
    squared += picture.noise_px * picture.noise_px * static_cast<double>(picture.corners.size());
    count += static_cast<double>(picture.corners.size());
    all.bundle.views.push_back(ViewOfCorners(picture, corners));
    all.bundle.views.back().camera = index.at(picture.camera);
  }
  all.repeats = split == PhotoSplit::kTrain ? CountRepeats(all.bundle.views)
                                            : std::vector<double>(all.pictures.size(), 1);
  // Before corners were looked at finely, nothing is known.
  all.noise_px = squared > 0 ? std::max(kLeastNoisePx, std::sqrt(squared / count))
                             : PlatformUnknowns().noise_px;
  for (size_t v = 0; v < all.pictures.size(); ++v) {
    const double own = std::max(kLeastNoisePx, adjustment.pictures[all.pictures[v]].noise_px);
    const bool known = adjustment.pictures[all.pictures[v]].noise_px > 0;
    all.bundle.views[v].weight =
        (known ? all.noise_px * all.noise_px / (own * own) : 1) / all.repeats[v];
  }
  if (adjustment.platform.moves != PlatformMoves::kNone || adjustment.platform.bent) {
    all.bundle.platform = MakePlatformUnknowns(board, adjustment.platform);
    all.bundle.platform->prior_mm = options.print_error_mm;
    all.bundle.platform->noise_px = all.noise_px;
  }
  return all;
}

Adjustment AdjustRobustly(Adjustment adjustment, const Board& board, const CalibOptions& options) {
  for (const auto& [name, camera] : adjustment.cameras) {
    if (!camera.known) RequireEnough(adjustment.pictures, name);
  }
  const AdjustmentBundle all = BundleOf(adjustment, board, PhotoSplit::kTrain, options);
  const JointResult result = AdjustJointly(all.bundle, options.robust_scale_px, kMaxIterations);
  size_t index = 0;
  for (auto& [name, camera] : adjustment.cameras) camera.camera = result.cameras[index++];
  for (size_t v = 0; v < all.pictures.size(); ++v) {
    adjustment.pictures[all.pictures[v]].camera_from_world = result.poses[v];
  }
  adjustment.shape = result.shape;
  return adjustment;
}

Adjustment AdjustCorners(Adjustment adjustment, const Board& board, const CalibOptions& options) {
  for (CalibPicture& picture : adjustment.pictures) picture.noise_px = 0;
  adjustment = AdjustRobustly(std::move(adjustment), board, options);
  const std::vector<Eigen::Vector3d> corners =
      CornerPositions(BoardCorners(board), adjustment.shape);
  const int least = LeastCorners(board, options);
  for (const auto& [name, camera] : adjustment.cameras) {
    std::vector<std::optional<Eigen::Vector2d>> errors;
    const std::vector<size_t> selected =
        SelectPictures(adjustment.pictures, name, PhotoSplit::kTrain);
    for (const size_t i : selected) {
      const auto own =
          ReprojectionErrors(camera.camera, ViewOfCorners(adjustment.pictures[i], corners));
      errors.insert(errors.end(), own.begin(), own.end());
    }
    const double sigma = RobustSigma(errors);
    for (const size_t i : selected) {
      adjustment.pictures[i] = DropOutliers(std::move(adjustment.pictures[i]), camera.camera,
                                            corners, sigma, least, options);
    }
  }
  EstimateNoise(adjustment, board, PhotoSplit::kTrain);
  adjustment = AdjustRobustly(std::move(adjustment), board, options);
  EstimateNoise(adjustment, board, PhotoSplit::kTrain);
  return adjustment;
}

Adjustment AdjustTestPoses(Adjustment adjustment, const Board& board, const CalibOptions& options) {
  const std::vector<Eigen::Vector3d> corners =
      CornerPositions(BoardCorners(board), adjustment.shape);
  for (const size_t i : InUse(adjustment, PhotoSplit::kTest)) {
    const Camera& camera = adjustment.cameras.at(adjustment.pictures[i].camera).camera;
    CalibPicture picture = DropOutliers(adjustment.pictures[i], camera, corners, 0,
                                        LeastCorners(board, options), options);
    picture.camera_from_world =
        AdjustPose(camera, ViewOfCorners(picture, corners), options.robust_scale_px);
    adjustment.pictures[i] = std::move(picture);
  }
  EstimateNoise(adjustment, board, PhotoSplit::kTest);
  return adjustment;
}

LensChoice ChooseLensTerms(const Adjustment& adjustment, const std::string& camera_name,
                           const Board& board, const CalibOptions& options) {
  const std::vector<Eigen::Vector3d> corners =
      CornerPositions(BoardCorners(board), adjustment.shape);
  std::vector<BundleView> views;
  for (const size_t i : SelectPictures(adjustment.pictures, camera_name, PhotoSplit::kTrain)) {
    views.push_back(ViewOfCorners(adjustment.pictures[i], corners));
  }
  return ChooseLensTerms(adjustment.cameras.at(camera_name).camera, views, options.robust_scale_px);
}

PlatformChoice ChoosePlatform(const Adjustment& adjustment, const Board& board,
                              const CalibOptions& options) {
  AdjustmentBundle all = BundleOf(adjustment, board, PhotoSplit::kTrain, options);
  all.bundle.platform.reset();
  return ChoosePlatform(board, all.bundle, options.print_error_mm, all.noise_px,
                        options.robust_scale_px);
}

void CheckObservable(const std::string& camera_name, const Camera& camera,
                     const Eigen::Matrix<double, kIntrinsics, kIntrinsics>& covariance) {
  const double size = std::max(camera.width, camera.height);
  const std::pair<int, double> most[] = {{0, kMaxFocalError * camera.fx},
                                         {1, kMaxFocalError * camera.fy},
                                         {2, kMaxCenterError * size},
                                         {3, kMaxCenterError * size}};
  for (const auto& [index, limit] : most) {
    if (std::sqrt(covariance(index, index)) <= limit) continue;
    throw Error("camera \"" + camera_name + "\": its " +
                (index < 2 ? "focal length" : "principal point") +
                " cannot be told from these pictures (the platform is seen from straight above "
                "only, or from one place?); add pictures from slanted directions all round, or "
                "give the camera's intrinsics in capture.json");
  }
}

}  // namespace lfm
