// SPDX-License-Identifier: BSD-3-Clause
#include "calib/calib_pictures.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "calib/corner_refinement.h"
#include "core/error.h"

namespace lfm {
namespace {

constexpr double kArrowScale = 100;
constexpr double kLargeResidualPx = 0.1;
// Drawing with four bits of fraction keeps lines where the numbers say.
constexpr int kFractionBits = 4;

const cv::Scalar kBlue(90, 160, 255), kGreen(80, 230, 80), kOrange(255, 170, 0), kRed(255, 50, 50);
const cv::Scalar kWhite(255, 255, 255);

cv::Point ToFixed(const Eigen::Vector2d& p) {
  return {static_cast<int>(std::lround(p.x() * (1 << kFractionBits))),
          static_cast<int>(std::lround(p.y() * (1 << kFractionBits)))};
}

void DrawLine(cv::Mat& canvas, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
              const cv::Scalar& color) {
  cv::line(canvas, ToFixed(from), ToFixed(to), color, 1, cv::LINE_AA, kFractionBits);
}

void DrawDot(cv::Mat& canvas, const Eigen::Vector2d& at, double radius, const cv::Scalar& color) {
  cv::circle(canvas, ToFixed(at), static_cast<int>(radius * (1 << kFractionBits)), color,
             cv::FILLED, cv::LINE_AA, kFractionBits);
}

Image DimmedRgb(const Image& photo) {
  const Image srgb = ToSrgb8(photo);
  Image canvas(photo.width(), photo.height(), 3, PixelType::kUint8, ColorEncoding::kSrgb);
  for (int y = 0; y < photo.height(); ++y) {
    for (int x = 0; x < photo.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        const int from = photo.channels() >= 3 ? c : 0;
        canvas.At<uint8_t>(x, y, c) = static_cast<uint8_t>(srgb.At<uint8_t>(x, y, from) * 3 / 5);
      }
    }
  }
  return canvas;
}

void DrawBoardOutline(cv::Mat& canvas, const Board& board, const PlatformShape& shape,
                      const Camera& camera, const Pose& camera_from_world) {
  const std::vector<Eigen::Vector3d> corners = CornerPositions(BoardCorners(board), shape);
  const size_t tag_corners = 4 * board.tags.size();
  for (size_t i = 0; i < corners.size(); ++i) {
    const auto here = Project(camera, camera_from_world * corners[i]);
    if (!here || !camera.Contains(*here)) continue;
    if (i >= tag_corners) {
      const Eigen::Vector2d right(3, 0), down(0, 3);
      DrawLine(canvas, *here - right, *here + right, kBlue);
      DrawLine(canvas, *here - down, *here + down, kBlue);
      continue;
    }
    const size_t next = i / 4 * 4 + (i + 1) % 4;
    const auto there = Project(camera, camera_from_world * corners[next]);
    if (there && camera.Contains(*there)) DrawLine(canvas, *here, *there, kBlue);
  }
}

}  // namespace

Image DrawCalibration(const Image& photo, const Board& board, const Camera& camera,
                      const PlatformShape& shape, const PosedImage& image) {
  if (photo.width() != camera.width || photo.height() != camera.height) {
    throw Error(image.file + ": the picture has not the size of camera \"" + image.camera + "\"");
  }
  Image drawing = DimmedRgb(photo);
  cv::Mat canvas(drawing.height(), drawing.width(), CV_8UC3, drawing.Data<uint8_t>());
  DrawBoardOutline(canvas, board, shape, camera, image.camera_from_world);

  const BoardPrint print = BoardPrint::WithMovedTags(MoveTags(board, shape));
  const std::vector<CornerPlace> corners = PlaceCornersOfMovedTags(board, shape);
  const Image gray = LinearGray(photo);
  CornerSearch search = {.max_shift_px = 3};
  const auto found = FindCorners(gray, print, corners, camera, image.camera_from_world, search);
  search.blur_px =
      EstimateBlur(gray, print, corners, camera, image.camera_from_world, found, search);
  for (const CornerObservation& corner :
       FindCorners(gray, print, corners, camera, image.camera_from_world, search)) {
    const auto projected =
        Project(camera, image.camera_from_world * corners[corner.corner].position);
    if (!projected) continue;
    const Eigen::Vector2d residual = corner.pixel - *projected;
    DrawDot(canvas, corner.pixel, 1.5, kGreen);
    DrawLine(canvas, corner.pixel, corner.pixel + kArrowScale * residual,
             residual.norm() > kLargeResidualPx ? kRed : kOrange);
  }
  const Eigen::Vector2d bar(10, drawing.height() - 12);
  DrawLine(canvas, bar, bar + Eigen::Vector2d(0.1 * kArrowScale, 0), kWhite);
  cv::putText(canvas, "0.1 px",
              cv::Point(static_cast<int>(0.1 * kArrowScale) + 16, drawing.height() - 8),
              cv::FONT_HERSHEY_SIMPLEX, 0.4, kWhite, 1, cv::LINE_AA);
  return drawing;
}

}  // namespace lfm
