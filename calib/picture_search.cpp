// SPDX-License-Identifier: BSD-3-Clause
#include "calib/picture_search.h"

#include <variant>

#include "calib/bundle_adjustment.h"
#include "calib/circle_match.h"
#include "calib/tag_detection.h"
#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

// A detector takes some tens of milliseconds to make: one serves a few pictures.
constexpr int64_t kPicturesPerDetector = 8;

// Blurred edges still pull when the start is pixels away.
constexpr double kRoughBlurPx = 1.5;
constexpr CornerSearch kRoughSearch = {
    .blur_px = kRoughBlurPx, .max_shift_px = 4.0, .max_relative_residual = 0.15};
constexpr CornerSearch kFineSearch = {.max_shift_px = 1.5};
constexpr int kMinRoughCorners = 4;

CalibPicture FindBoard(CalibPicture picture, const Capture& capture, const Board& board,
                       const ImageLoader& load_image, BoardSearch start, TagDetector& detector) {
  try {
    const Image image = load_image(picture.file);
    const CaptureCamera& camera = capture.cameras.at(picture.camera);
    if (image.width() != camera.width || image.height() != camera.height) {
      const auto size = [](int w, int h) { return std::to_string(w) + "x" + std::to_string(h); };
      picture.rejected = "is " + size(image.width(), image.height()) + ", but camera \"" +
                         picture.camera + "\" is " + size(camera.width, camera.height);
      return picture;
    }
    std::variant<BoardMatch, BoardMismatch> match =
        ChooseMatch(MatchBoard(board, detector.Detect(image)), board, image, start);
    if (const BoardMismatch* mismatch = std::get_if<BoardMismatch>(&match)) {
      picture.rejected = mismatch->reason;
    } else {
      picture.match = std::get<BoardMatch>(std::move(match));
    }
  } catch (const Error& error) {
    picture.rejected = error.what();
  }
  return picture;
}

CalibPicture SearchAndPose(CalibPicture picture, const Image& gray, const BoardPrint& print,
                           const std::vector<Eigen::Vector3d>& corners, const Camera& camera,
                           const CornerSearch& search, double robust_scale_px) {
  picture.corners = FindCorners(gray, print, corners, camera, picture.camera_from_world, search);
  if (static_cast<int>(picture.corners.size()) >= kMinRoughCorners) {
    picture.camera_from_world =
        AdjustPose(camera, ViewOfCorners(picture, corners), robust_scale_px);
  }
  return picture;
}

}  // namespace

BundleView ViewOfCorners(const CalibPicture& picture, const std::vector<Eigen::Vector3d>& corners) {
  BundleView view;
  view.camera_from_world = picture.camera_from_world;
  for (const CornerObservation& observation : picture.corners) {
    view.points.push_back(corners[observation.corner]);
    view.pixels.push_back(observation.pixel);
  }
  return view;
}

std::vector<CalibPicture> FindBoards(std::vector<CalibPicture> pictures, const Capture& capture,
                                     const Board& board, const ImageLoader& load_image,
                                     BoardSearch start, Progress& progress) {
  progress.Start("finding tags", static_cast<int64_t>(pictures.size()));
  ParallelChunks(static_cast<int64_t>(pictures.size()), kPicturesPerDetector,
                 [&](int64_t begin, int64_t end, int64_t) {
                   TagDetector detector(board.family, board.border_cells);
                   for (int64_t i = begin; i < end; ++i) {
                     CalibPicture& picture = pictures[static_cast<size_t>(i)];
                     if (picture.InUse()) {
                       picture = FindBoard(std::move(picture), capture, board, load_image, start,
                                           detector);
                     }
                     progress.Advance();
                   }
                 });
  return pictures;
}

std::vector<CalibPicture> RefineCorners(std::vector<CalibPicture> pictures,
                                        const std::string& camera_name, PhotoSplit split,
                                        const Camera& camera, const Board& board,
                                        const ImageLoader& load_image, StartQuality start,
                                        const CalibOptions& options, Progress& progress) {
  std::vector<size_t> selected;
  for (size_t i = 0; i < pictures.size(); ++i) {
    const CalibPicture& picture = pictures[i];
    if (picture.InUse() && picture.camera == camera_name && picture.split == split) {
      selected.push_back(i);
    }
  }
  const BoardPrint print(board);
  const std::vector<Eigen::Vector3d> corners = BoardCorners(board);
  progress.Start("refining corners", static_cast<int64_t>(selected.size()));
  ParallelFor(0, static_cast<int64_t>(selected.size()), [&](int64_t i) {
    CalibPicture picture = pictures[selected[static_cast<size_t>(i)]];
    const Image gray = LinearGray(load_image(picture.file));
    if (start == StartQuality::kRough) {
      picture = SearchAndPose(std::move(picture), BlurGray(gray, kRoughBlurPx), print, corners,
                              camera, kRoughSearch, options.robust_scale_px);
      picture.blur_px = EstimateBlur(gray, print, corners, camera, picture.camera_from_world,
                                     picture.corners, kFineSearch);
    }
    CornerSearch fine = kFineSearch;
    fine.blur_px = picture.blur_px;
    picture = SearchAndPose(std::move(picture), gray, print, corners, camera, fine,
                            options.robust_scale_px);
    if (static_cast<int>(picture.corners.size()) < options.min_corners) {
      picture.rejected = "only " + std::to_string(picture.corners.size()) +
                         " corners found, at least " + std::to_string(options.min_corners) +
                         " are needed; blurred, or the platform is hidden?";
    }
    pictures[selected[static_cast<size_t>(i)]] = std::move(picture);
    progress.Advance();
  });
  return pictures;
}

}  // namespace lfm
