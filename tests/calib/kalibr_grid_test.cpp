// SPDX-License-Identifier: BSD-3-Clause
#include "calib/kalibr_grid.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "calib/board_match.h"
#include "calib/platform_shape.h"
#include "calib/tag_detection.h"
#include "core/error.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

const char* const kGood =
    "target_type: 'aprilgrid' #gridtype\n"
    "tagCols: 6               #number of apriltags\n"
    "tagRows: 5               #number of apriltags\n"
    "tagSize: 0.088           #size of apriltag, edge to edge [m]\n"
    "tagSpacing: 0.3          #ratio of space between tags to tagSize\n";

class KalibrGrid : public testing::Test {
 protected:
  std::filesystem::path Write(const std::string& text) const {
    const std::filesystem::path file = scratch_.folder / "grid.yaml";
    std::ofstream(file, std::ios::binary) << text;
    return file;
  }
  ScratchFolder scratch_;
};

TEST_F(KalibrGrid, IsReadInMillimetres) {
  const Board board = ReadKalibrGrid(Write(kGood));
  EXPECT_EQ(board.border_cells, 2);
  EXPECT_NEAR(board.tag_size_mm, 88, 1e-9);
  ASSERT_EQ(board.tags.size(), 30u);
  ASSERT_EQ(board.squares.size(), 42u);
  const double pitch = 88 * 1.3;
  EXPECT_LT((board.tags[1].center_mm - board.tags[0].center_mm - Eigen::Vector2d(pitch, 0)).norm(),
            1e-9);
  EXPECT_LT((board.tags[6].center_mm - board.tags[0].center_mm - Eigen::Vector2d(0, pitch)).norm(),
            1e-9)
      << "rows go upwards";
  EXPECT_LT((board.tags[0].center_mm - Eigen::Vector2d(-2.5 * pitch, -2 * pitch)).norm(), 1e-9);
  // Where four tags come together there is a square whose corners are theirs.
  const BoardPrint print(board);
  const Eigen::Vector2d corner = board.tags[0].center_mm + Eigen::Vector2d(44, 44);
  EXPECT_EQ(print.Value(corner + Eigen::Vector2d(1, 1)), 0);
  EXPECT_EQ(print.Value(corner + Eigen::Vector2d(-1, -1)), 0);
  EXPECT_EQ(print.Value(corner + Eigen::Vector2d(1, -1)), 1);
  EXPECT_EQ(print.Value(corner + Eigen::Vector2d(-1, 1)), 1);
}

TEST_F(KalibrGrid, TagsThatMovedIntoItsSquaresCanStillBeDrawn) {
  const Board board = ReadKalibrGrid(Write(kGood));
  PlatformShape shape;
  shape.shifts_mm.assign(BoardCorners(board).size(), Eigen::Vector2d(0.3, -0.2));
  const Board moved = MoveTags(board, shape);
  EXPECT_THROW(BoardPrint{moved}, Error);
  const BoardPrint print = BoardPrint::WithMovedTags(moved);
  // The first tag's border, black, a little inside its shifted left edge.
  const Eigen::Vector2d left = board.tags[0].center_mm + Eigen::Vector2d(0.3 - 44, -0.2);
  EXPECT_EQ(print.Value(left + Eigen::Vector2d(0.5, 0)), 0);
  EXPECT_EQ(print.Value(left - Eigen::Vector2d(0.5, 0)), 1);
}

TEST_F(KalibrGrid, ItsPictureIsDetectedAndMatched) {
  const Board board = ReadKalibrGrid(Write(kGood));
  TagDetector detector(board.family, board.border_cells);
  const auto match = MatchBoard(board, detector.Detect(DrawBoard(board, 1)));
  ASSERT_TRUE(std::holds_alternative<BoardMatch>(match));
  EXPECT_EQ(std::get<BoardMatch>(match).tags, 30);
  const BoardMatch& found = std::get<BoardMatch>(match);
  constexpr double kCorner_abs = 0.9;  // px; a start for the corner search
  for (size_t i = 0; i < found.pixels.size(); ++i) {
    const Eigen::Vector2d expected(found.points_mm[i].x() + board.width_mm / 2 - 0.5,
                                   board.height_mm / 2 - found.points_mm[i].y() - 0.5);
    EXPECT_LT((found.pixels[i] - expected).norm(), kCorner_abs);
  }
}

TEST_F(KalibrGrid, RoundTrip) {
  const Board board = ReadKalibrGrid(Write(std::string(kGood) + "codeOffset: 12\n"));
  EXPECT_EQ(board.tags[0].id, 12);
  WriteKalibrGrid(board, scratch_.folder / "again.yaml");
  const Board again = ReadKalibrGrid(scratch_.folder / "again.yaml");
  EXPECT_NEAR(again.tag_size_mm, board.tag_size_mm, 1e-9);
  ASSERT_EQ(again.tags.size(), board.tags.size());
  for (size_t i = 0; i < board.tags.size(); ++i) {
    EXPECT_EQ(again.tags[i].id, board.tags[i].id);
    EXPECT_LT((again.tags[i].center_mm - board.tags[i].center_mm).norm(), 1e-7);
  }
}

TEST_F(KalibrGrid, OtherBoardsAreNotExported) {
  EXPECT_THROW(WriteKalibrGrid(DefaultBoard(), scratch_.folder / "x.yaml"), Error);
  Board board = ReadKalibrGrid(Write(kGood));
  board.squares.clear();
  EXPECT_NO_THROW(WriteKalibrGrid(board, scratch_.folder / "x.yaml"));
  board.tags[7].center_mm.x() += 1;
  EXPECT_THROW(WriteKalibrGrid(board, scratch_.folder / "y.yaml"), Error);
  board = ReadKalibrGrid(Write(kGood));
  board.tags[0].rotation = 3.14159;
  EXPECT_THROW(WriteKalibrGrid(board, scratch_.folder / "y.yaml"), Error);
  board = ReadKalibrGrid(Write(kGood));
  board.tags.pop_back();
  EXPECT_THROW(WriteKalibrGrid(board, scratch_.folder / "y.yaml"), Error);
  EXPECT_FALSE(std::filesystem::exists(scratch_.folder / "y.yaml"));
}

TEST_F(KalibrGrid, RefusesHostileFiles) {
  const std::vector<std::pair<std::string, std::string>> changes = {
      {"aprilgrid", "checkerboard"},
      {"tagCols: 6 ", "tagCols: 0 "},
      {"tagCols: 6 ", "tagCols: 99999999999 "},
      {"tagCols: 6 ", "tagCols: 6.5 "},
      {"tagCols: 6 ", "tagRows: 6 "},
      {"tagCols: 6 ", "tagCols "},
      {"0.088", "nan"},
      {"0.088", "inf"},
      {"0.088", "-1"},
      {"0.088", "1e999"},
      {"0.088", ""},
      {"0.088", "88"},
      {"0.088 ", "0.088 m "},
      {"0.3", "0"},
      {"tagSpacing", "tagspacing"},
      {"tagCols: 6 ", "tagCols: 100 "},  // too many for the family with 100 rows
      {"tagRows: 5", "tagRows: 100"}};
  for (const auto& [from, to] : changes) {
    std::string text = kGood;
    text.replace(text.find(from), from.size(), to);
    if (from == "tagCols: 6 " && to == "tagCols: 100 ") {
      text.replace(text.find("tagRows: 5"), 10, "tagRows: 100");
    }
    if (from == "tagRows: 5") text += "codeOffset: 400\n";
    EXPECT_THROW(ReadKalibrGrid(Write(text)), Error) << text;
  }
  const std::string good = kGood;
  for (size_t length = 0; length < good.find("tagSpacing: 0.") + 14; ++length) {
    EXPECT_THROW(ReadKalibrGrid(Write(good.substr(0, length))), Error) << length;
  }
  EXPECT_THROW(ReadKalibrGrid(Write(good + "extra: 1\n")), Error);
  EXPECT_THROW(ReadKalibrGrid(Write(std::string(100000, 'a'))), Error);
  EXPECT_THROW(ReadKalibrGrid(scratch_.folder / "none.yaml"), Error);
  try {
    std::string text = kGood;
    text.replace(text.find("0.088"), 5, "88");
    ReadKalibrGrid(Write(text));
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("is this millimetres?"), std::string::npos);
  }
}

// Photographs of such boards by others: that they match says which way up the tags are printed.
TEST_F(KalibrGrid, RealPhotographsMatch) {
  const char* data = std::getenv("LFM_REAL_DATA");
  if (data == nullptr) GTEST_SKIP() << "LFM_REAL_DATA is not set";
  std::string six = kGood;
  six.replace(six.find("tagRows: 5"), 10, "tagRows: 6");
  const Board board = ReadKalibrGrid(Write(six));
  TagDetector detector(board.family, board.border_cells);
  // Of 36 tags; right.png is a fisheye's view from the side.
  for (const auto& [file, tags] : {std::pair("EuRoC.png", 36), std::pair("two_boards.png", 36),
                                   std::pair("TUM_VI.png", 33), std::pair("right.png", 22)}) {
    const Image photo =
        ReadImage(std::filesystem::path(data) / "tag_boards" / file, ColorEncoding::kSrgb);
    const auto match = MatchBoard(board, detector.Detect(photo));
    ASSERT_TRUE(std::holds_alternative<BoardMatch>(match))
        << file << ": " << std::get<BoardMismatch>(match).reason;
    EXPECT_GE(std::get<BoardMatch>(match).tags, tags) << file;
  }
}

}  // namespace
}  // namespace lfm
