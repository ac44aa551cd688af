// SPDX-License-Identifier: BSD-3-Clause
#include "calib/calib.h"

#include <algorithm>
#include <cmath>

#include "calib/bundle_adjustment.h"
#include "calib/camera_adjustment.h"
#include "calib/lens_choice.h"
#include "calib/picture_search.h"
#include "core/error.h"

namespace lfm {
namespace {

// Corners are searched from rough poses first; once more from good ones, where the print is
// rendered with the right lens.
constexpr StartQuality kRounds[] = {StartQuality::kRough, StartQuality::kGood};

CameraAdjustment CalibrateCamera(std::vector<CalibPicture> pictures, const std::string& name,
                                 const Capture& capture, const Board& board,
                                 const ImageLoader& load_image, const CalibOptions& options,
                                 Progress& progress) {
  const CaptureCamera& given = capture.cameras.at(name);
  CameraAdjustment adjustment =
      StartCamera(std::move(pictures), name, given.width, given.height, given.intrinsics);
  for (const StartQuality start : kRounds) {
    adjustment.pictures =
        RefineCorners(std::move(adjustment.pictures), name, PhotoSplit::kTrain, adjustment.camera,
                      board, load_image, start, options, progress);
    if (start == StartQuality::kGood && !given.intrinsics) {
      adjustment.lens_terms = ChooseLensTerms(adjustment, name, board, options);
    }
    adjustment = AdjustCamera(std::move(adjustment), name, board, given.intrinsics, options);
  }
  adjustment.pictures =
      StartPoses(std::move(adjustment.pictures), name, PhotoSplit::kTest, adjustment.camera);
  for (const StartQuality start : kRounds) {
    adjustment.pictures =
        RefineCorners(std::move(adjustment.pictures), name, PhotoSplit::kTest, adjustment.camera,
                      board, load_image, start, options, progress);
  }
  adjustment.pictures =
      AdjustTestPoses(std::move(adjustment.pictures), name, adjustment.camera, board, options);
  return adjustment;
}

PosedImage MakePosedImage(const CalibPicture& picture, const BundleView& view, const Camera& camera,
                          double noise_px) {
  PosedImage posed;
  posed.id = picture.id;
  posed.camera = picture.camera;
  posed.file = picture.file;
  posed.camera_from_world = picture.camera_from_world;
  posed.tags = picture.match.tags;
  posed.corners = static_cast<int>(picture.corners.size());
  posed.split = picture.split;
  if (picture.kind != PictureKind::kPhoto) {
    for (size_t i = 0; i < view.points.size(); ++i) {
      posed.seen.push_back({view.points[i], view.pixels[i]});
    }
  }
  const CornerStatistics statistics = ComputeCornerStatistics(camera, {view}, 0);
  posed.reprojection_rms_px =
      std::sqrt(statistics.squared_px2 / static_cast<double>(statistics.corners));
  posed.covariance =
      CovarianceFromInformation(ComputeInformation(camera, {view}).poses[0], noise_px * noise_px);
  return posed;
}

double NoiseOfCamera(const CameraAdjustment& adjustment, const std::string& name,
                     const std::vector<Eigen::Vector3d>& corners, bool intrinsics_known) {
  std::vector<BundleView> views;
  for (const CalibPicture& picture : adjustment.pictures) {
    if (picture.InUse() && picture.camera == name && picture.split == PhotoSplit::kTrain) {
      views.push_back(ViewOfCorners(picture, corners));
    }
  }
  const int fitted = intrinsics_known ? 0 : 4 + adjustment.lens_terms;
  const double noise = ComputeCornerStatistics(adjustment.camera, views, fitted).noise_px;
  if (!intrinsics_known) {
    CheckFocalObservable(name, adjustment.camera, views, noise, adjustment.lens_terms);
  }
  return noise;
}

}  // namespace

CalibResult Calibrate(const Capture& capture, const Board& board, const ImageLoader& load_image,
                      const CalibOptions& options, Progress& progress) {
  CalibOptions checked = options;
  ValidateOptions(AnyOptions(checked));
  ValidateBoard(board, board.name.empty() ? "board" : board.name);
  std::vector<CalibPicture> pictures = ListPictures(capture);
  if (pictures.empty()) {
    throw Error((capture.folder / "capture.json").string() +
                ": no pictures; list at least three photographs of the platform");
  }
  pictures = FindBoards(std::move(pictures), capture, board, load_image, progress);
  const std::vector<Eigen::Vector3d> corners = BoardCorners(board);
  CalibResult result;
  std::map<std::string, double> noise_of_camera;
  for (const auto& [name, given] : capture.cameras) {
    const bool used = std::any_of(pictures.begin(), pictures.end(),
                                  [&](const CalibPicture& p) { return p.camera == name; });
    if (!used) continue;
    CameraAdjustment adjustment =
        CalibrateCamera(std::move(pictures), name, capture, board, load_image, checked, progress);
    noise_of_camera[name] = NoiseOfCamera(adjustment, name, corners, given.intrinsics.has_value());
    result.cameras[name] = adjustment.camera;
    if (!given.intrinsics) result.lens_terms[name] = adjustment.lens_terms;
    pictures = std::move(adjustment.pictures);
  }
  double squared = 0, noise_squared = 0;
  int64_t count = 0;
  for (const CalibPicture& picture : pictures) {
    if (!picture.InUse()) {
      result.rejected.push_back({picture.id, picture.file, picture.rejected});
      continue;
    }
    const double noise = noise_of_camera.at(picture.camera);
    const PosedImage posed = MakePosedImage(picture, ViewOfCorners(picture, corners),
                                            result.cameras.at(picture.camera), noise);
    if (picture.kind == PictureKind::kScan) {
      result.scans.push_back(posed);
    } else if (picture.kind == PictureKind::kPlacement) {
      result.placements.push_back(posed);
    } else {
      result.photos.push_back(posed);
      if (picture.split != PhotoSplit::kTrain) continue;
      squared += posed.reprojection_rms_px * posed.reprojection_rms_px * posed.corners;
      noise_squared += noise * noise * posed.corners;
      count += posed.corners;
    }
  }
  if (count > 0) {
    result.reprojection_rms_px = std::sqrt(squared / static_cast<double>(count));
    result.corner_noise_px = std::sqrt(noise_squared / static_cast<double>(count));
  }
  return result;
}

}  // namespace lfm
