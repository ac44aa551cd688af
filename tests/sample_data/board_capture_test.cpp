// SPDX-License-Identifier: BSD-3-Clause
// Captures on boards of any design: what is printed is what is photographed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <numbers>

#include "calib/board.h"
#include "calib/board_design.h"
#include "calib/calib.h"
#include "core/error.h"
#include "sample_data/plate.h"
#include "sample_data/studio.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

Board CirclesAndAWall() {
  BoardDesign design;
  design.layout = BoardLayout::kCircles;
  design.circles = 12;
  design.checker_columns = design.checker_rows = 11;
  Board board = DesignBoard(design);
  AttachedBoard wall;
  wall.board.name = "wall";
  wall.board.width_mm = 120;
  wall.board.height_mm = 50;
  wall.board.tag_size_mm = 30;
  wall.board.tags = {{40, {-30, 0}, 0}, {41, {30, 0}, 0}};
  wall.world_from_board.rotation =
      Eigen::AngleAxisd(std::numbers::pi / 3, V3::UnitX()).toRotationMatrix();
  wall.world_from_board.translation = {0, 145, 20};
  board.attached.push_back(wall);
  return board;
}

TEST(SetReflectance, KnowsColoursAndAttachedBoards) {
  const Board board = CirclesAndAWall();
  const SetReflectance reflectance(board);
  const Pose table{Eigen::Matrix3d::Identity(), {0, 0, -kPlateThicknessMm}};
  const std::vector<Patch> patches = MakePlateAndTable(board, table);
  EXPECT_EQ(patches.back().material, PatchMaterial::kTable);
  const Patch& plate = patches.at(0);
  const BoardCircle& circle = board.circles[2];
  const Eigen::Vector3f there(static_cast<float>(circle.center_mm.x()),
                              static_cast<float>(circle.center_mm.y()), 0);
  const Eigen::Vector3f color = reflectance.Color(plate, there);
  const Eigen::Vector3f ink = CircleReflectance(circle.color);
  for (int c = 0; c < 3; ++c) EXPECT_EQ(color[c] > 0.2f, ink[c] > 0.25f) << c;
  EXPECT_NEAR(reflectance.Albedo(plate, there),
              0.2126f * color.x() + 0.7152f * color.y() + 0.0722f * color.z(), 1e-6f);
  // The wall's print, at its own place: a tag's border is black, the gap between the tags white.
  const auto print =
      std::find_if(patches.begin(), patches.end(), [](const Patch& p) { return p.plate == 1; });
  ASSERT_NE(print, patches.end());
  EXPECT_EQ(print->material, PatchMaterial::kPrint);
  const Pose& pose = board.attached[0].world_from_board;
  EXPECT_LT((print->Normal() - pose.rotation * V3::UnitZ()).norm(), 1e-12);
  EXPECT_LT((print->origin - pose * V3(-60, -25, 0)).norm(), 1e-12);
  EXPECT_LT(reflectance.Albedo(*print, (pose * V3(-30, 14, 0)).cast<float>()), 0.1f);
  EXPECT_EQ(reflectance.Albedo(*print, (pose * V3(0, 0, 0)).cast<float>()), kPaperAlbedo);
  // A bent platform keeps the wall.
  const std::vector<Patch> bent = MakeBentPlateAndTable(board, 1, table);
  EXPECT_EQ(
      std::count_if(bent.begin(), bent.end(), [](const Patch& p) { return p.plate == 1; }),
      std::count_if(patches.begin(), patches.end(), [](const Patch& p) { return p.plate == 1; }));
}

TEST(PrintedBoard, ScalesEverythingThatIsPrinted) {
  const Board nominal = CirclesAndAWall();
  PlatformTrouble trouble;
  trouble.print_scale_percent = -1;
  const Board printed = PrintedBoard(nominal, trouble, 1);
  EXPECT_NEAR(printed.circles[3].diameter_mm, 0.99 * nominal.circles[3].diameter_mm, 1e-12);
  EXPECT_LT((printed.circles[3].center_mm - 0.99 * nominal.circles[3].center_mm).norm(), 1e-12);
  EXPECT_NEAR(printed.attached[0].board.tag_size_mm, 29.7, 1e-12);
  EXPECT_NEAR(printed.attached[0].board.tags[0].center_mm.x(), -29.7, 1e-12);
}

// From a board file to poses: nothing but coloured circles tells where the platform is when the
// wall is hidden behind the object.
TEST(BoardCapture, IsCalibratedFromItsCirclesAndTags) {
  const ScratchFolder scratch;
  const Board board = CirclesAndAWall();
  WriteBoard(board, scratch.folder / "board.json");
  StudioOptions options;
  options.board = (scratch.folder / "board.json").string();
  options.tiny = true;
  options.photos = 8;
  options.test_photos = 1;
  options.photo_width = 480;
  options.photo_height = 360;
  options.scans = options.placements = 0;
  std::map<std::string, Image> pictures;
  std::mutex mutex;
  const StudioResult studio = RenderStudio(
      options,
      [&](const std::string& file, const Image& picture) {
        const std::lock_guard lock(mutex);
        pictures.emplace(file, picture);
      },
      SilentProgress());
  EXPECT_EQ(studio.board.circles.size(), board.circles.size());
  const CalibResult result = Calibrate(
      studio.capture, studio.board, [&](const std::string& file) { return pictures.at(file); }, {},
      SilentProgress());
  // The bust hides the wall, and all but three circles, from one place or another.
  EXPECT_LE(result.rejected.size(), 2u);
  ASSERT_GE(result.photos.size(), 6u);
  constexpr double kCenter_abs = 0.6, kReprojection_abs = 0.12;
  for (size_t i = 0; i < result.photos.size(); ++i) {
    const PosedImage& found = result.photos[i];
    const auto truth = std::find_if(studio.truth.photos.begin(), studio.truth.photos.end(),
                                    [&](const Photo& photo) { return photo.id == found.id; });
    ASSERT_NE(truth, studio.truth.photos.end());
    EXPECT_LT((found.camera_from_world.Center() - truth->camera_from_world->Center()).norm(),
              kCenter_abs)
        << i;
  }
  EXPECT_LT(result.reprojection_rms_px, kReprojection_abs);
}

TEST(BoardCapture, ABadBoardFileIsAnError) {
  StudioOptions options;
  options.board = "/nonexistent/board.json";
  options.tiny = true;
  const auto render = [&] {
    RenderStudio(
        options, [](const std::string&, const Image&) {}, SilentProgress());
  };
  EXPECT_THROW(render(), Error);
  const ScratchFolder scratch;
  Board vast = DefaultBoard();
  vast.width_mm = 50000;
  WriteBoard(vast, scratch.folder / "board.json");
  options.board = (scratch.folder / "board.json").string();
  EXPECT_THROW(render(), Error) << "larger than the table";
}

TEST(BoardCapture, ABoardGivenInMetresIsRefusedWithTheCure) {
  const ScratchFolder scratch;
  Board board;
  board.width_mm = board.height_mm = 0.1;
  board.tag_size_mm = 0.024;
  board.tags = {{0, {-0.02, 0}, 0}, {1, {0.02, 0}, 0}};
  StudioOptions options;
  options.tiny = true;
  options.board = (scratch.folder / "board.json").string();
  WriteBoard(board, options.board);
  const auto no_picture = [](const std::string& file, const Image&) { ADD_FAILURE() << file; };
  try {
    RenderStudio(options, no_picture, SilentProgress());
    ADD_FAILURE() << "took it";
  } catch (const Error& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find(options.board + ": tag_size_mm"), std::string::npos) << what;
    EXPECT_NE(what.find("Multiply every length of the file by 1000"), std::string::npos) << what;
  }
}

}  // namespace
}  // namespace lfm
