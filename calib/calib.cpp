// SPDX-License-Identifier: BSD-3-Clause
#include "calib/calib.h"

#include <algorithm>
#include <cmath>

#include "calib/bundle_adjustment.h"
#include "calib/camera_adjustment.h"
#include "calib/picture_search.h"
#include "core/error.h"

namespace lfm {
namespace {

constexpr int kIntrinsics = 9;

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

/// How well the corners of one camera are seen.
struct CornerNoise {
  double reference_sigma_px = 0;  ///< predicted for a corner of weight 1
  CornerStatistics observed;
};

PosedImage MakePosedImage(const CalibPicture& picture, const std::vector<Eigen::Vector3d>& corners,
                          const Camera& camera, const CornerNoise& noise) {
  PosedImage posed;
  posed.id = picture.id;
  posed.camera = picture.camera;
  posed.file = picture.file;
  posed.camera_from_world = picture.camera_from_world;
  posed.tags = picture.match.tags;
  posed.corners = static_cast<int>(picture.corners.size());
  posed.split = picture.split;
  const BundleView view = ViewOfCorners(picture, corners, noise.reference_sigma_px);
  const CornerStatistics statistics = ComputeCornerStatistics(camera, {view}, 0);
  posed.reprojection_rms_px =
      std::sqrt(statistics.squared_px2 / static_cast<double>(statistics.corners));
  posed.covariance =
      CovarianceFromInformation(ComputeInformation(camera, {view}).poses[0],
                                noise.observed.unit_noise_px * noise.observed.unit_noise_px);
  return posed;
}

CornerNoise ExamineCamera(const CameraAdjustment& adjustment, const std::string& name,
                          const std::vector<Eigen::Vector3d>& corners, bool intrinsics_known) {
  const std::vector<CalibPicture> training = TrainingPictures(adjustment.pictures, name);
  CornerNoise noise;
  noise.reference_sigma_px = MedianSigma(training);
  std::vector<BundleView> views;
  for (const CalibPicture& picture : training) {
    views.push_back(ViewOfCorners(picture, corners, noise.reference_sigma_px));
  }
  noise.observed =
      ComputeCornerStatistics(adjustment.camera, views, intrinsics_known ? 0 : kIntrinsics);
  if (!intrinsics_known) {
    CheckFocalObservable(name, adjustment.camera, views, noise.observed.unit_noise_px);
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
  std::map<std::string, CornerNoise> noise_of_camera;
  for (const auto& [name, given] : capture.cameras) {
    const bool used = std::any_of(pictures.begin(), pictures.end(),
                                  [&](const CalibPicture& p) { return p.camera == name; });
    if (!used) continue;
    CameraAdjustment adjustment =
        CalibrateCamera(std::move(pictures), name, capture, board, load_image, checked, progress);
    noise_of_camera[name] = ExamineCamera(adjustment, name, corners, given.intrinsics.has_value());
    result.cameras[name] = adjustment.camera;
    pictures = std::move(adjustment.pictures);
  }
  double squared = 0, noise_squared = 0;
  int64_t count = 0;
  for (const CalibPicture& picture : pictures) {
    if (!picture.InUse()) {
      result.rejected.push_back({picture.id, picture.file, picture.rejected});
      continue;
    }
    const CornerNoise& noise = noise_of_camera.at(picture.camera);
    const PosedImage posed =
        MakePosedImage(picture, corners, result.cameras.at(picture.camera), noise);
    if (picture.kind == PictureKind::kScan) {
      result.scans.push_back(posed);
    } else if (picture.kind == PictureKind::kPlacement) {
      result.placements.push_back(posed);
    } else {
      result.photos.push_back(posed);
      squared += posed.reprojection_rms_px * posed.reprojection_rms_px * posed.corners;
      noise_squared += noise.observed.noise_px * noise.observed.noise_px * posed.corners;
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
