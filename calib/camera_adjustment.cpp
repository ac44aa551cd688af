// SPDX-License-Identifier: BSD-3-Clause
#include "calib/camera_adjustment.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "calib/bundle_adjustment.h"
#include "calib/picture_search.h"
#include "calib/pose_estimation.h"
#include "core/error.h"

namespace lfm {
namespace {

constexpr int kMinPictures = 3;
constexpr int kIntrinsics = 9;
constexpr double kUsualFocalInWidths = 1.2;
constexpr double kMaxFocalError = 0.02;
constexpr double kOutlierSigmas = 4.5;
// Detected tag corners are off by half a pixel, and by more before the lens is known.
constexpr double kLensUnknownScalePx = 4.0;
constexpr double kDetectionScalePx = 1.0;

std::string Rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  return text;
}

bool Selected(const CalibPicture& picture, const std::string& camera_name, PhotoSplit split) {
  return picture.InUse() && picture.camera == camera_name && picture.split == split;
}

std::vector<size_t> SelectPictures(const std::vector<CalibPicture>& pictures,
                                   const std::string& camera_name, PhotoSplit split) {
  std::vector<size_t> selected;
  for (size_t i = 0; i < pictures.size(); ++i) {
    if (Selected(pictures[i], camera_name, split)) selected.push_back(i);
  }
  return selected;
}

void RequireEnough(const std::vector<CalibPicture>& pictures, const std::string& camera_name) {
  const size_t in_use = SelectPictures(pictures, camera_name, PhotoSplit::kTrain).size();
  if (in_use >= kMinPictures) return;
  std::string first;
  for (const CalibPicture& picture : pictures) {
    if (picture.camera == camera_name && !picture.InUse() && first.empty()) {
      first = "; set aside, for example: " + picture.file + ": " + picture.rejected;
    }
  }
  throw Error("camera \"" + camera_name + "\": " + std::to_string(in_use) +
              " usable training picture" + (in_use == 1 ? "" : "s") +
              " of the platform; at least three are needed, from different directions" + first);
}

std::vector<Eigen::Vector3d> OnPlate(const std::vector<Eigen::Vector2d>& points_mm) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector2d& p : points_mm) points.emplace_back(p.x(), p.y(), 0.0);
  return points;
}

BundleView ViewOfTags(const CalibPicture& picture) {
  return {picture.camera_from_world, picture.match.world_points, picture.match.world_pixels};
}

Camera AdjustToTags(const Camera& camera, std::vector<CalibPicture>& pictures,
                    const std::string& camera_name, const BundleOptions& options) {
  std::vector<BundleView> views;
  const std::vector<size_t> selected = SelectPictures(pictures, camera_name, PhotoSplit::kTrain);
  for (const size_t i : selected) views.push_back(ViewOfTags(pictures[i]));
  const BundleResult result = AdjustBundle(camera, views, options);
  for (size_t v = 0; v < selected.size(); ++v) {
    pictures[selected[v]].camera_from_world = result.poses[v];
  }
  return result.camera;
}

double RobustSigma(const Camera& camera, const std::vector<BundleView>& views) {
  std::vector<double> magnitudes;
  for (const BundleView& view : views) {
    for (const auto& error : ReprojectionErrors(camera, view)) {
      if (!error) continue;
      magnitudes.push_back(std::abs(error->x()));
      magnitudes.push_back(std::abs(error->y()));
    }
  }
  if (magnitudes.empty()) return 0;
  const auto middle = magnitudes.begin() + static_cast<std::ptrdiff_t>(magnitudes.size() / 2);
  std::nth_element(magnitudes.begin(), middle, magnitudes.end());
  return 1.4826 * *middle;
}

// Keeps the corners that a picture's own noise explains, then judges what is left.
CalibPicture DropOutliers(CalibPicture picture, const Camera& camera,
                          const std::vector<Eigen::Vector3d>& corners, double common_sigma_px,
                          const CalibOptions& options) {
  const BundleView view = ViewOfCorners(picture, corners);
  const double limit =
      kOutlierSigmas * std::max(common_sigma_px, RobustSigma(camera, {view})) + 1e-9;
  const auto errors = ReprojectionErrors(camera, view);
  std::vector<CornerObservation> kept;
  double squared = 0;
  for (size_t i = 0; i < errors.size(); ++i) {
    if (!errors[i] || errors[i]->norm() > limit) continue;
    kept.push_back(picture.corners[i]);
    squared += errors[i]->squaredNorm();
  }
  const double rms = kept.empty() ? 0 : std::sqrt(squared / static_cast<double>(kept.size()));
  if (static_cast<int>(kept.size()) < options.min_corners) {
    picture.rejected = "only " + std::to_string(kept.size()) + " of " +
                       std::to_string(errors.size()) + " corners agree with one pose, at least " +
                       std::to_string(options.min_corners) + " are needed";
  } else if (rms > options.max_reprojection_px) {
    picture.rejected = "its corners fit to " + Rounded(rms) + " px only, more than " +
                       Rounded(options.max_reprojection_px) +
                       " px; another board, or one that is not flat?";
  }
  picture.corners = std::move(kept);
  return picture;
}

CameraAdjustment AdjustOnce(CameraAdjustment adjustment, const std::string& camera_name,
                            const std::vector<Eigen::Vector3d>& corners,
                            const std::optional<Camera>& known, const CalibOptions& options) {
  const std::vector<size_t> selected =
      SelectPictures(adjustment.pictures, camera_name, PhotoSplit::kTrain);
  std::vector<BundleView> views;
  for (const size_t i : selected) views.push_back(ViewOfCorners(adjustment.pictures[i], corners));
  if (known) {
    for (size_t v = 0; v < views.size(); ++v) {
      adjustment.pictures[selected[v]].camera_from_world =
          AdjustPose(*known, views[v], options.robust_scale_px);
    }
    return adjustment;
  }
  RequireEnough(adjustment.pictures, camera_name);
  const BundleResult result = AdjustBundle(
      KeepLensTerms(adjustment.camera, adjustment.lens_terms), views,
      {.lens_terms = adjustment.lens_terms, .robust_scale_px = options.robust_scale_px});
  adjustment.camera = result.camera;
  for (size_t v = 0; v < selected.size(); ++v) {
    adjustment.pictures[selected[v]].camera_from_world = result.poses[v];
  }
  return adjustment;
}

}  // namespace

std::vector<CalibPicture> StartPoses(std::vector<CalibPicture> pictures,
                                     const std::string& camera_name, PhotoSplit split,
                                     const Camera& camera) {
  for (const size_t i : SelectPictures(pictures, camera_name, split)) {
    CalibPicture& picture = pictures[i];
    const std::optional<Pose> pose = EstimatePlanarPose(camera, OnPlate(picture.match.points_mm),
                                                        picture.match.pixels, kDetectionScalePx);
    if (pose) {
      picture.camera_from_world = *pose * picture.match.world_from_plate.Inverse();
    } else {
      picture.rejected = "no pose explains its tags";
    }
  }
  return pictures;
}

CameraAdjustment StartCamera(std::vector<CalibPicture> pictures, const std::string& camera_name,
                             int width, int height, const std::optional<Camera>& known) {
  if (known) {
    return {*known, StartPoses(std::move(pictures), camera_name, PhotoSplit::kTrain, *known)};
  }
  RequireEnough(pictures, camera_name);
  std::vector<Eigen::Matrix3d> homographies;
  for (const size_t i : SelectPictures(pictures, camera_name, PhotoSplit::kTrain)) {
    homographies.push_back(pictures[i].match.pixel_from_board);
  }
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = FocalFromHomographies(homographies, width, height)
                              .value_or(kUsualFocalInWidths * std::max(width, height));
  camera.cx = (width - 1) / 2.0;
  camera.cy = (height - 1) / 2.0;
  pictures = StartPoses(std::move(pictures), camera_name, PhotoSplit::kTrain, camera);
  RequireEnough(pictures, camera_name);
  camera = AdjustToTags(
      camera, pictures, camera_name,
      {.free = FreeIntrinsics::kFocalAndRadial, .robust_scale_px = kLensUnknownScalePx});
  // With a lens, the other one of the two planar poses may turn out to be the right one.
  pictures = StartPoses(std::move(pictures), camera_name, PhotoSplit::kTrain, camera);
  RequireEnough(pictures, camera_name);
  camera = AdjustToTags(camera, pictures, camera_name, {.robust_scale_px = kDetectionScalePx});
  return {camera, std::move(pictures)};
}

CameraAdjustment AdjustCamera(CameraAdjustment adjustment, const std::string& camera_name,
                              const Board& board, const std::optional<Camera>& known,
                              const CalibOptions& options) {
  const std::vector<Eigen::Vector3d> corners = BoardCorners(board);
  adjustment = AdjustOnce(std::move(adjustment), camera_name, corners, known, options);
  const std::vector<size_t> selected =
      SelectPictures(adjustment.pictures, camera_name, PhotoSplit::kTrain);
  std::vector<BundleView> views;
  for (const size_t i : selected) views.push_back(ViewOfCorners(adjustment.pictures[i], corners));
  const double sigma = RobustSigma(adjustment.camera, views);
  for (const size_t i : selected) {
    CalibPicture& picture = adjustment.pictures[i];
    picture = DropOutliers(std::move(picture), adjustment.camera, corners, sigma, options);
  }
  return AdjustOnce(std::move(adjustment), camera_name, corners, known, options);
}

std::vector<CalibPicture> AdjustTestPoses(std::vector<CalibPicture> pictures,
                                          const std::string& camera_name, const Camera& camera,
                                          const Board& board, const CalibOptions& options) {
  const std::vector<Eigen::Vector3d> corners = BoardCorners(board);
  for (const size_t i : SelectPictures(pictures, camera_name, PhotoSplit::kTest)) {
    CalibPicture picture = DropOutliers(pictures[i], camera, corners, 0, options);
    picture.camera_from_world =
        AdjustPose(camera, ViewOfCorners(picture, corners), options.robust_scale_px);
    pictures[i] = std::move(picture);
  }
  return pictures;
}

CornerStatistics ComputeCornerStatistics(const Camera& camera, const std::vector<BundleView>& views,
                                         int fitted_intrinsics) {
  CornerStatistics statistics;
  double unknowns = fitted_intrinsics;
  for (const BundleView& view : views) {
    for (const auto& error : ReprojectionErrors(camera, view)) {
      if (!error) continue;
      ++statistics.corners;
      statistics.squared_px2 += error->squaredNorm();
    }
    unknowns += view.points.empty() ? 0 : 6;
  }
  const double freedom = 2.0 * static_cast<double>(statistics.corners) - unknowns;
  statistics.noise_px = freedom > 0 ? std::sqrt(statistics.squared_px2 / freedom) : 0;
  return statistics;
}

void CheckFocalObservable(const std::string& camera_name, const Camera& camera,
                          const std::vector<BundleView>& views, double noise_px, int lens_terms) {
  // Exact corners would make anything look certain: half a hundredth of a pixel is assumed at
  // least.
  constexpr double kLeastNoisePx = 0.005;
  const double noise = std::max(noise_px, kLeastNoisePx);
  const int fitted = 4 + lens_terms;  // terms that were not fitted are known to be 0
  const Eigen::MatrixXd covariance = CovarianceFromInformation(
      ComputeInformation(camera, views).intrinsics.topLeftCorner(fitted, fitted), noise * noise);
  for (const auto& [variance, focal] :
       {std::pair(covariance(0, 0), camera.fx), std::pair(covariance(1, 1), camera.fy)}) {
    if (std::sqrt(variance) <= kMaxFocalError * std::abs(focal)) continue;
    throw Error("camera \"" + camera_name +
                "\": its focal length cannot be told from these pictures (the platform is seen "
                "from straight above only?); add pictures from slanted directions");
  }
}

}  // namespace lfm
