// SPDX-License-Identifier: BSD-3-Clause
// Whole calibrations on boards other than the usual one.
#include <gtest/gtest.h>

#include <numbers>

#include "calib/board_design.h"
#include "calib/calib.h"
#include "calib/kalibr_grid.h"
#include "calib/tag_family.h"
#include "core/error.h"
#include "core/progress.h"
#include "rendered_board.h"

namespace lfm {
namespace {

constexpr double kCenter_abs = 0.25, kRotation_deg_abs = 0.05, kFocal_rel = 1e-3;

void ExpectCalibrates(const Board& board, const CalibOptions& options, double center_abs) {
  const RenderedCapture rendered = RenderCapture(board, 6, 0);
  const CalibResult result =
      Calibrate(rendered.capture, board, rendered.Loader(), options, SilentProgress());
  for (const RejectedImage& image : result.rejected) ADD_FAILURE() << image.reason;
  EXPECT_NEAR(result.cameras.at("photo").fx, rendered.camera.fx, kFocal_rel * rendered.camera.fx);
  for (size_t i = 0; i < result.photos.size(); ++i) {
    const Pose &found = result.photos[i].camera_from_world, &truth = rendered.poses[i];
    EXPECT_LT((found.Center() - truth.Center()).norm(), center_abs) << i;
    EXPECT_LT(RotationAngle(found.rotation, truth.rotation) * 180 / std::numbers::pi,
              kRotation_deg_abs)
        << i;
  }
}

// What is said of a capture that cannot be calibrated.
std::string Complaint(const RenderedCapture& rendered, const Board& board,
                      const CalibOptions& options) {
  try {
    Calibrate(rendered.capture, board, rendered.Loader(), options, SilentProgress());
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(BoardCalibration, CirclesAloneStartTheCornerSearch) {
  BoardDesign design;
  design.layout = BoardLayout::kCircles;
  const Board board = DesignBoard(design);
  ExpectCalibrates(board, {}, kCenter_abs);
}

TEST(BoardCalibration, SaysWhyCirclesAreNotFound) {
  BoardDesign design;
  design.layout = BoardLayout::kCircles;
  Board board = DesignBoard(design);
  RenderedCapture rendered = RenderCapture(board, 3, 0);
  const std::string tags_only = Complaint(rendered, board, {.start = BoardSearch::kTags});
  EXPECT_NE(tags_only.find("--start auto"), std::string::npos) << tags_only;
  Image& picture = rendered.pictures[1];
  const Image seen = picture;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        picture.At<uint8_t>(x, y, c) = seen.At<uint8_t>(picture.width() - 1 - x, y, c);
      }
    }
  }
  const std::string mirrored = Complaint(rendered, board, {});
  EXPECT_NE(mirrored.find("is mirrored"), std::string::npos) << mirrored;
  for (BoardCircle& circle : board.circles) circle.diameter_mm /= 1000;
  const std::string in_metres = Complaint(rendered, board, {});
  EXPECT_NE(in_metres.find("given in metres"), std::string::npos) << in_metres;
}

TEST(BoardCalibration, TagsAlone) {
  BoardDesign design;
  design.layout = BoardLayout::kGrid;
  ExpectCalibrates(DesignBoard(design), {}, kCenter_abs);
}

TEST(BoardCalibration, TagsWithDataOutsideTheirBorder) {
  BoardDesign design;
  design.family = "tagStandard41h12";
  design.tag_size_mm = 15;
  ExpectCalibrates(DesignBoard(design), {}, kCenter_abs);
}

// Two boards that lean outwards beside the platform: their corners are found in their own planes.
TEST(BoardCalibration, AttachedBoardsInOtherPlanes) {
  Board board = DefaultBoard();
  board.tags.resize(7);
  BoardDesign side;
  side.name = "side";
  side.layout = BoardLayout::kGrid;
  side.width_mm = 200;
  side.height_mm = 46;
  side.tag_columns = 5;
  side.tag_rows = 1;
  side.tag_pitch_mm = 38;
  side.tag_size_mm = 26;
  for (int i = 0; i < 2; ++i) {
    side.first_id = 100 + 10 * i;
    const double angle = i == 0 ? 0.6 : -0.5;
    AttachedBoard attached;
    attached.board = DesignBoard(side);
    attached.world_from_board.rotation =
        (Eigen::AngleAxisd(i * std::numbers::pi / 2, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()))
            .toRotationMatrix();
    attached.world_from_board.translation =
        i == 0 ? Eigen::Vector3d(0, -135, -12) : Eigen::Vector3d(-137, 0, 15);
    board.attached.push_back(attached);
  }
  const RenderedCapture rendered = RenderCapture(board, 8, 1);
  const CalibResult result =
      Calibrate(rendered.capture, board, rendered.Loader(), {}, SilentProgress());
  EXPECT_TRUE(result.rejected.empty());
  Board alone = board;
  alone.attached.clear();
  const CalibResult without =
      Calibrate(rendered.capture, alone, rendered.Loader(), {}, SilentProgress());
  int corners = 0, corners_without = 0;
  for (size_t i = 0; i < result.photos.size(); ++i) {
    const Pose &found = result.photos[i].camera_from_world, &truth = rendered.poses[i];
    EXPECT_LT((found.Center() - truth.Center()).norm(), kCenter_abs) << i;
    corners += result.photos[i].corners;
  }
  for (const PosedImage& photo : without.photos) corners_without += photo.corners;
  EXPECT_GT(corners, corners_without + 20 * static_cast<int>(result.photos.size()))
      << "most of their 40 corners are used";
  EXPECT_LT(result.reprojection_rms_px, 0.1);
}

}  // namespace
}  // namespace lfm
