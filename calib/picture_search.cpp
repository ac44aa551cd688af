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
// A coarse look is quick and loses some corners in a hundred: too many where there are few.
constexpr size_t kManyCorners = 64;

// Left and right exchanged; 8 bits do for tags.
Image MirrorImage(const Image& image) {
  const Image picture = ToSrgb8(image);
  Image mirrored = picture;
  const int channels = picture.channels();
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      for (int c = 0; c < channels; ++c) {
        mirrored.At<uint8_t>(x, y, c) = picture.At<uint8_t>(picture.width() - 1 - x, y, c);
      }
    }
  }
  return mirrored;
}

bool ShowsBoard(const Image& image, const Board& board, TagDetector& detector) {
  if (!detector.Detect(image).empty()) return true;
  return !board.circles.empty() &&
         std::holds_alternative<BoardMatch>(MatchCircles(board, DetectCircles(image)));
}

CalibPicture FindBoard(CalibPicture picture, const Board& board, const ImageLoader& load_image,
                       BoardSearch start, TagDetector& detector) {
  try {
    const Image image = load_image(picture.file);
    picture.width = image.width(), picture.height = image.height();
    const std::vector<TagDetection> tags = detector.Detect(image);
    std::variant<BoardMatch, BoardMismatch> match =
        ChooseMatch(MatchBoard(board, tags), board, image, start);
    if (const BoardMismatch* mismatch = std::get_if<BoardMismatch>(&match)) {
      picture.rejected = mismatch->reason;
      if (tags.empty() && ShowsBoard(MirrorImage(image), board, detector)) {
        picture.rejected =
            "is mirrored: its tags or circles can be read in its mirror image only; turn it back, "
            "or take it without the mirror";
      }
    } else {
      picture.match = std::get<BoardMatch>(std::move(match));
    }
  } catch (const Error& error) {
    picture.rejected = error.what();
  }
  return picture;
}

CalibPicture SearchAndPose(CalibPicture picture, const Image& gray, const BoardPrint& print,
                           const std::vector<CornerPlace>& corners,
                           const std::vector<Eigen::Vector3d>& positions, const Camera& camera,
                           const CornerSearch& search, double robust_scale_px) {
  picture.corners = FindCorners(gray, print, corners, camera, picture.camera_from_world, search);
  if (static_cast<int>(picture.corners.size()) >= kMinRoughCorners) {
    picture.camera_from_world =
        AdjustPose(camera, ViewOfCorners(picture, positions), robust_scale_px);
  }
  return picture;
}

std::vector<Eigen::Matrix2d> WeighCorners(const std::vector<CornerObservation>& corners) {
  constexpr double kLeastVariance = 0.25;  // of the median
  constexpr double kRoundness = 0.05;      // of a corner's variance, in all directions
  std::vector<double> variances;
  for (const CornerObservation& c : corners) variances.push_back(c.covariance.trace() / 2);
  if (variances.empty()) return {};
  std::vector<double> sorted = variances;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double least = kLeastVariance * *middle;
  // Exact corners, and those whose fit was not asked, weigh alike.
  if (!(least > 0)) return {};
  std::vector<Eigen::Matrix2d> weights;
  double sum = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const double round = std::max(kRoundness * variances[i], least - variances[i]);
    const Eigen::Matrix2d covariance = corners[i].covariance + round * Eigen::Matrix2d::Identity();
    weights.emplace_back(covariance.inverse());
    sum += weights.back().trace() / 2;
  }
  for (Eigen::Matrix2d& w : weights) w *= static_cast<double>(weights.size()) / sum;
  return weights;
}

}  // namespace

BundleView ViewOfCorners(const CalibPicture& picture,
                         const std::vector<Eigen::Vector3d>& positions) {
  BundleView view;
  view.camera_from_world = picture.camera_from_world;
  for (const CornerObservation& observation : picture.corners) {
    view.points.push_back(positions[observation.corner]);
    view.pixels.push_back(observation.pixel);
    view.corners.push_back(observation.corner);
  }
  view.corner_weights = WeighCorners(picture.corners);
  return view;
}

std::vector<CalibPicture> FindBoards(std::vector<CalibPicture> pictures, const Board& board,
                                     const ImageLoader& load_image, BoardSearch start,
                                     Progress& progress) {
  progress.Start("finding tags", static_cast<int64_t>(pictures.size()));
  ParallelChunks(static_cast<int64_t>(pictures.size()), kPicturesPerDetector,
                 [&](int64_t begin, int64_t end, int64_t) {
                   TagDetector detector(board.family, board.border_cells);
                   for (int64_t i = begin; i < end; ++i) {
                     CalibPicture& picture = pictures[static_cast<size_t>(i)];
                     if (picture.InUse()) {
                       picture = FindBoard(std::move(picture), board, load_image, start, detector);
                     }
                     progress.Advance();
                   }
                 });
  return pictures;
}

std::vector<CalibPicture> RefineCorners(std::vector<CalibPicture> pictures,
                                        const std::string& camera_name, PhotoSplit split,
                                        const Camera& camera, const Board& board,
                                        const PlatformShape& shape, const ImageLoader& load_image,
                                        StartQuality start, int least_corners,
                                        const CalibOptions& options, Progress& progress) {
  std::vector<size_t> selected;
  for (size_t i = 0; i < pictures.size(); ++i) {
    const CalibPicture& picture = pictures[i];
    if (picture.InUse() && picture.camera == camera_name && picture.split == split) {
      selected.push_back(i);
    }
  }
  const BoardPrint print = BoardPrint::WithMovedTags(MoveTags(board, shape));
  const std::vector<CornerPlace> corners = PlaceCornersOfMovedTags(board, shape);
  const std::vector<Eigen::Vector3d> positions = CornerPositions(BoardCorners(board), shape);
  progress.Start("refining corners", static_cast<int64_t>(selected.size()));
  ParallelFor(0, static_cast<int64_t>(selected.size()), [&](int64_t i) {
    CalibPicture picture = pictures[selected[static_cast<size_t>(i)]];
    const Image gray = LinearGray(load_image(picture.file));
    if (start == StartQuality::kRough) {
      picture = SearchAndPose(std::move(picture), BlurGray(gray, kRoughBlurPx), print, corners,
                              positions, camera, kRoughSearch, options.robust_scale_px);
    }
    // Twice: where the lens is not known yet, what looks like blur is often its distortion.
    picture.blur_px = EstimateBlur(gray, print, corners, camera, picture.camera_from_world,
                                   picture.corners, kFineSearch);
    CornerSearch fine = kFineSearch;
    fine.blur_px = picture.blur_px;
    if (start == StartQuality::kRough && corners.size() >= kManyCorners) {
      fine.sampling = PixelSampling::kCoarse;
    }
    picture = SearchAndPose(std::move(picture), gray, print, corners, positions, camera, fine,
                            options.robust_scale_px);
    if (static_cast<int>(picture.corners.size()) < least_corners) {
      picture.rejected = "only " + std::to_string(picture.corners.size()) +
                         " corners found, at least " + std::to_string(least_corners) +
                         " are needed; blurred, or the platform is hidden?";
    }
    pictures[selected[static_cast<size_t>(i)]] = std::move(picture);
    progress.Advance();
  });
  return pictures;
}

}  // namespace lfm
