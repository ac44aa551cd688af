// SPDX-License-Identifier: BSD-3-Clause
#include "calib/calib.h"

#include <algorithm>
#include <cmath>

#include "calib/camera_adjustment.h"
#include "calib/camera_groups.h"
#include "calib/camera_start.h"
#include "calib/picture_search.h"
#include "core/error.h"

namespace lfm {
namespace {

Adjustment StartCameras(CameraGroups groups) {
  Adjustment adjustment;
  std::vector<CalibPicture> pictures = std::move(groups.pictures);
  for (const auto& [name, given] : groups.cameras) {
    const bool used = std::any_of(pictures.begin(), pictures.end(),
                                  [&](const CalibPicture& p) { return p.camera == name; });
    if (!used) continue;
    CameraStart start =
        StartCamera(std::move(pictures), name, given.width, given.height, given.intrinsics);
    pictures = std::move(start.pictures);
    adjustment.cameras[name] = {start.camera, given.intrinsics.has_value()};
  }
  adjustment.pictures = std::move(pictures);
  return adjustment;
}

/// What every step of a calibration needs beside the state that it moves.
struct Studio {
  const Board& board;
  const ImageLoader& load_image;
  const CalibOptions& options;
  Progress& progress;
};

Adjustment RefineAll(Adjustment adjustment, PhotoSplit split, StartQuality start,
                     const Studio& studio) {
  for (const auto& [name, camera] : adjustment.cameras) {
    adjustment.pictures =
        RefineCorners(std::move(adjustment.pictures), name, split, camera.camera, studio.board,
                      adjustment.shape, studio.load_image, start,
                      LeastCorners(studio.board, studio.options), studio.options, studio.progress);
  }
  return adjustment;
}

Adjustment ChooseLenses(Adjustment adjustment, CalibResult& result, const Studio& studio) {
  for (auto& [name, camera] : adjustment.cameras) {
    if (camera.known) continue;
    const LensChoice lens = ChooseLensTerms(adjustment, name, studio.board, studio.options);
    camera.lens_terms = lens.terms;
    result.lens_trials[name] = lens.trials;
  }
  return adjustment;
}

bool DepartsFromPrint(const Adjustment& adjustment) {
  return adjustment.platform.bent || adjustment.platform.moves != PlatformMoves::kNone;
}

// Lenses are chosen again when the platform turned out not to be as printed: its errors may have
// passed for lens terms.
Adjustment ChooseModels(Adjustment adjustment, CalibResult& result, const Studio& studio) {
  adjustment = ChooseLenses(std::move(adjustment), result, studio);
  const PlatformChoice platform = ChoosePlatform(adjustment, studio.board, studio.options);
  adjustment.platform = platform.model;
  result.platform_trials = platform.trials;
  if (!DepartsFromPrint(adjustment)) return adjustment;
  adjustment = AdjustCorners(std::move(adjustment), studio.board, studio.options);
  return ChooseLenses(std::move(adjustment), result, studio);
}

// Corners are searched from rough poses first; once more from good ones, where the print is
// rendered with the right lens at the right place; and again where the platform turned out not to
// be as printed, since corners far off were out of reach. No picture is judged before it is known
// what the platform looks like.
Adjustment AdjustTraining(Adjustment adjustment, CalibResult& result, const Studio& studio) {
  adjustment = RefineAll(std::move(adjustment), PhotoSplit::kTrain, StartQuality::kRough, studio);
  adjustment = AdjustRobustly(std::move(adjustment), studio.board, studio.options);
  adjustment = ChooseModels(std::move(adjustment), result, studio);
  adjustment = AdjustCorners(std::move(adjustment), studio.board, studio.options);
  const int rounds = DepartsFromPrint(adjustment) ? 2 : 1;
  for (int round = 0; round < rounds; ++round) {
    adjustment = RefineAll(std::move(adjustment), PhotoSplit::kTrain, StartQuality::kGood, studio);
    adjustment = ChooseModels(std::move(adjustment), result, studio);
    adjustment = AdjustCorners(std::move(adjustment), studio.board, studio.options);
  }
  return adjustment;
}

Adjustment PoseTests(Adjustment adjustment, const Studio& studio) {
  for (const auto& [name, camera] : adjustment.cameras) {
    adjustment.pictures =
        StartPoses(std::move(adjustment.pictures), name, PhotoSplit::kTest, camera.camera);
  }
  for (const StartQuality start : {StartQuality::kRough, StartQuality::kGood}) {
    adjustment = RefineAll(std::move(adjustment), PhotoSplit::kTest, start, studio);
  }
  return AdjustTestPoses(std::move(adjustment), studio.board, studio.options);
}

PosedImage MakePosedImage(const CalibPicture& picture, const Camera& camera, const BundleView& view,
                          const Eigen::Matrix<double, 6, 6>& covariance) {
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
  double squared = 0;
  int projected = 0;
  for (const auto& error : ReprojectionErrors(camera, view)) {
    if (!error) continue;
    squared += error->squaredNorm();
    ++projected;
  }
  posed.reprojection_rms_px = std::sqrt(squared / std::max(1, projected));
  posed.covariance = covariance;
  return posed;
}

/// Covariances of all pictures that are in use, by their place among the pictures.
std::map<size_t, Eigen::Matrix<double, 6, 6>> PoseCovariances(const Adjustment& adjustment,
                                                              CalibResult& result,
                                                              const Studio& studio) {
  AdjustmentBundle train = BundleOf(adjustment, studio.board, PhotoSplit::kTrain, studio.options);
  AdjustmentBundle test = BundleOf(adjustment, studio.board, PhotoSplit::kTest, studio.options);
  // All are weighed against the training pictures' noise.
  const double ratio = train.noise_px / test.noise_px;
  std::vector<BundleView> followers = std::move(test.bundle.views);
  for (BundleView& view : followers) view.weight *= ratio * ratio;
  // A picture's own pose is none the worse known for copies of the picture.
  std::vector<size_t> pictures = test.pictures;
  for (size_t v = 0; v < train.pictures.size(); ++v) {
    if (train.repeats[v] <= 1) continue;
    followers.push_back(train.bundle.views[v]);
    followers.back().weight *= train.repeats[v];
    pictures.push_back(train.pictures[v]);
  }
  const BundleCovariance covariance =
      ComputeCovariance(train.bundle, adjustment.shape, train.noise_px, followers);
  size_t index = 0;
  for (const auto& [name, camera] : adjustment.cameras) {
    const auto& of_camera = covariance.cameras[index++];
    if (camera.known) continue;
    CheckObservable(name, camera.camera, of_camera);
    const int adjusted = kFirstLensTerm + camera.lens_terms;
    result.intrinsics_covariance[name] = of_camera.topLeftCorner(adjusted, adjusted);
    result.lens_terms[name] = camera.lens_terms;
  }
  std::map<size_t, Eigen::Matrix<double, 6, 6>> poses;
  for (size_t v = 0; v < train.pictures.size(); ++v) poses[train.pictures[v]] = covariance.poses[v];
  for (size_t f = 0; f < pictures.size(); ++f) poses[pictures[f]] = covariance.followers[f];
  return poses;
}

void ListPosed(const Adjustment& adjustment, const Studio& studio, CalibResult& result) {
  const auto covariances = PoseCovariances(adjustment, result, studio);
  const std::vector<Eigen::Vector3d> corners =
      CornerPositions(BoardCorners(studio.board), adjustment.shape);
  double squared = 0, noise_squared = 0;
  int64_t count = 0;
  for (size_t i = 0; i < adjustment.pictures.size(); ++i) {
    const CalibPicture& picture = adjustment.pictures[i];
    if (!picture.InUse()) {
      result.rejected.push_back({picture.id, picture.file, picture.rejected});
      continue;
    }
    const PosedImage posed = MakePosedImage(picture, adjustment.cameras.at(picture.camera).camera,
                                            ViewOfCorners(picture, corners), covariances.at(i));
    if (picture.kind == PictureKind::kScan) {
      result.scans.push_back(posed);
    } else if (picture.kind == PictureKind::kPlacement) {
      result.placements.push_back(posed);
    } else {
      result.photos.push_back(posed);
      if (picture.split != PhotoSplit::kTrain) continue;
      squared += posed.reprojection_rms_px * posed.reprojection_rms_px * posed.corners;
      noise_squared += picture.noise_px * picture.noise_px * posed.corners;
      count += posed.corners;
    }
  }
  if (count > 0) {
    result.reprojection_rms_px = std::sqrt(squared / static_cast<double>(count));
    result.corner_noise_px = std::sqrt(noise_squared / static_cast<double>(count));
  }
}

}  // namespace

CalibResult Calibrate(const Capture& capture, const Board& board, const ImageLoader& load_image,
                      const CalibOptions& options, Progress& progress) {
  CalibOptions checked = options;
  ValidateOptions(AnyOptions(checked));
  const std::string board_name = board.name.empty() ? "board" : board.name;
  ValidateBoard(board, board_name);
  RequireReadableMarks(board, board_name);
  std::vector<CalibPicture> pictures = ListPictures(capture);
  if (pictures.empty()) {
    throw Error((capture.folder / "capture.json").string() +
                ": no pictures; list at least three photographs of the platform");
  }
  const Studio studio{board, load_image, checked, progress};
  pictures = FindBoards(std::move(pictures), board, load_image, checked.start, progress);
  const ExifReader read_exif = [&](const std::string& file) {
    return ReadExifCamera(capture.folder / file);
  };
  CalibResult result;
  Adjustment adjustment = StartCameras(GroupByExif(std::move(pictures), capture, read_exif));
  adjustment = AdjustTraining(std::move(adjustment), result, studio);
  adjustment = PoseTests(std::move(adjustment), studio);
  for (const auto& [name, camera] : adjustment.cameras) result.cameras[name] = camera.camera;
  result.platform_model = PlatformModelName(adjustment.platform);
  result.platform_shape = adjustment.shape;
  ListPosed(adjustment, studio, result);
  return result;
}

}  // namespace lfm
