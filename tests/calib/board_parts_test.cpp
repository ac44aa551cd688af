// SPDX-License-Identifier: BSD-3-Clause
// Circles, squares and attached boards; board_test.cpp has the rest.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>

#include "calib/board.h"
#include "calib/board_design.h"
#include "calib/corner_refinement.h"
#include "core/error.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

// A plate with everything, and another one that stands upright behind it.
Board Everything() {
  BoardDesign design;
  design.width_mm = design.height_mm = 260;
  design.tag_columns = design.tag_rows = 7;
  design.tag_size_mm = 20;
  design.tag_pitch_mm = 38;
  design.checker_square_mm = 14;
  design.circles = 8;
  design.circle_diameter_mm = 12;
  Board board = DesignBoard(design);
  board.squares = {{{-127, 127}, 4}, {{127, -127}, 4}};
  AttachedBoard wall;
  wall.board.name = "wall";
  wall.board.width_mm = 100;
  wall.board.height_mm = 60;
  wall.board.tag_size_mm = 30;
  wall.board.tags = {{100, {-25, 0}, 0}, {101, {25, 0}, 0.1}};
  wall.world_from_board.rotation =
      Eigen::AngleAxisd(std::acos(-1.0) / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  wall.world_from_board.translation = {0, 140, 40};
  board.attached.push_back(wall);
  return board;
}

std::string MessageOf(const Board& board) {
  try {
    ValidateBoard(board, "board.json");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(BoardParts, EverythingTogetherIsValid) { EXPECT_EQ(MessageOf(Everything()), ""); }

TEST(BoardParts, RejectsEveryViolation) {
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  const std::vector<std::pair<std::string, std::function<void(Board&)>>> violations = {
      {"circles[0]: the centre", [&](Board& b) { b.circles[0].center_mm.x() = nan; }},
      {"circles[0]: the centre", [](Board& b) { b.circles[0].diameter_mm = 0; }},
      {"circles[0]: the centre", [&](Board& b) { b.circles[0].diameter_mm = infinite; }},
      {"plate's edge",
       [](Board& b) {
         b.circles[2].center_mm = {129, 0};
       }},
      {"from tags[", [](Board& b) { b.circles[0].center_mm = b.tags[0].center_mm; }},
      {"from the checker",
       [](Board& b) {
         b.circles[0].center_mm = {0, 0};
       }},
      {"from circles[0]",
       [](Board& b) { b.circles[1].center_mm = b.circles[0].center_mm + Eigen::Vector2d(14, 0); }},
      {"from squares[",
       [](Board& b) {
         b.squares[0] = {{b.circles[0].center_mm}, 4};
       }},
      {"squares[1]: the centre", [&](Board& b) { b.squares[1].size_mm = nan; }},
      {"squares[1]: leaves", [](Board& b) { b.squares[1].center_mm.x() = 128.5; }},
      {"overlaps the checker",
       [](Board& b) {
         b.squares[1].center_mm = {0, 0};
       }},
      {"overlaps squares[0]", [](Board& b) { b.squares[1] = b.squares[0]; }},
      {"closer than one cell to tags[",
       [](Board& b) { b.squares[1].center_mm = b.tags[3].center_mm + Eigen::Vector2d(14, 0); }},
      {"attached[0]: tags[1]: id 5 is used twice",
       [](Board& b) { b.attached[0].board.tags[1].id = 5; }},
      {"attached[0]: family", [](Board& b) { b.attached[0].board.family = "tag25h9"; }},
      {"nothing can be attached", [](Board& b) { b.attached[0].board.attached = b.attached; }},
      {"neither tags nor a checker", [](Board& b) { b.attached[0].board.tags.clear(); }},
      {"translation", [&](Board& b) { b.attached[0].world_from_board.translation.z() = nan; }},
      {"rotation", [](Board& b) { b.attached[0].world_from_board.rotation *= 1.1; }},
      {"covers a part", [](Board& b) { b.attached[0].world_from_board = Pose(); }},
      {"border_cells", [](Board& b) { b.border_cells = 3; }},
      {"border_cells", [](Board& b) { b.border_cells = 0; }},
      {"four circles",
       [](Board& b) {
         b.tags.clear();
         b.attached.clear();
         b.circles.resize(3);
       }},
      {"look the same", [](Board& b) {
         b.tags.clear();
         b.attached.clear();
         for (BoardCircle& c : b.circles) c.color = CircleColor::kRed;
       }}};
  for (const auto& [expected, violate] : violations) {
    Board board = Everything();
    violate(board);
    const std::string message = MessageOf(board);
    EXPECT_NE(message.find(expected), std::string::npos) << expected << " in: " << message;
  }
}

TEST(BoardParts, SquaresMayTouchTagsAtTheirCorners) {
  Board board = Everything();
  const double reach = board.tag_size_mm / 2 + 3;
  board.squares = {{board.tags[3].center_mm + Eigen::Vector2d(reach, reach), 6}};
  EXPECT_EQ(MessageOf(board), "");
  board.squares[0].center_mm.x() -= 0.1;
  EXPECT_NE(MessageOf(board).find("closer than one cell"), std::string::npos);
}

TEST(BoardParts, PrintShowsCirclesInColourAndSquaresBlack) {
  const Board board = Everything();
  const BoardPrint print(board);
  for (const BoardCircle& circle : board.circles) {
    for (const double radius : {0.0, 3.0, 5.99}) {
      const Eigen::Vector2d p = circle.center_mm + Eigen::Vector2d(0, radius);
      EXPECT_EQ(print.Value(p), -1);
      EXPECT_EQ(print.Color(p).value(), CircleReflectance(circle.color));
      EXPECT_EQ(print.UniformRadius(p), 0);
    }
    EXPECT_EQ(print.Value(circle.center_mm + Eigen::Vector2d(0, 6.01)), 1);
  }
  EXPECT_EQ(print.Value({-127, 127}), 0);
  EXPECT_EQ(print.Value({-125.01, 125.01}), 0);
  EXPECT_EQ(print.Value({-124.99, 125.01}), 1);
  EXPECT_EQ(print.Color({-127, 127}).value(), Eigen::Vector3f::Zero());
  EXPECT_FALSE(print.Color({131, 0}));
}

TEST(BoardParts, CornersOfAttachedBoardsFollowInTheWorld) {
  const Board board = Everything();
  const BoardPrint print(board);
  const std::vector<Eigen::Vector3d> corners = BoardCorners(board);
  const size_t own = 4 * board.tags.size() + 81;
  ASSERT_EQ(corners.size(), own + 8);
  EXPECT_LT((corners[own] - Eigen::Vector3d(-40, 140, 55)).norm(), 1e-12) << "tag 100, top left";
  ASSERT_EQ(print.Plates(), 2);
  EXPECT_EQ(print.PlateOfCorner(static_cast<int>(own) - 1).print, &print);
  const BoardPrint::Plate wall = print.PlateOfCorner(static_cast<int>(own));
  EXPECT_NE(wall.print, &print);
  EXPECT_EQ(wall.print->Value({-25, 14}), 0) << "the border of tag 100";
  EXPECT_EQ(wall.print->Value({51, 0}), -1);
  EXPECT_THROW(print.PlateOfCorner(static_cast<int>(own) + 8), Error);
  EXPECT_THROW(print.PlateOfCorner(-1), Error);
  EXPECT_THROW(print.PlateAt(2), Error);
  const BoardPrint copy = print;
  EXPECT_EQ(copy.PlateAt(0).print, &copy) << "a copy is its own";
}

TEST(BoardParts, JsonRoundTrip) {
  const ScratchFolder scratch;
  const Board board = Everything();
  WriteBoard(board, scratch.folder / "board.json");
  const Board read = ReadBoard(scratch.folder / "board.json");
  ASSERT_EQ(read.circles.size(), board.circles.size());
  for (size_t i = 0; i < board.circles.size(); ++i) {
    EXPECT_EQ(read.circles[i].center_mm, board.circles[i].center_mm);
    EXPECT_EQ(read.circles[i].diameter_mm, board.circles[i].diameter_mm);
    EXPECT_EQ(read.circles[i].color, board.circles[i].color);
  }
  ASSERT_EQ(read.squares.size(), 2u);
  EXPECT_EQ(read.squares[1].center_mm, board.squares[1].center_mm);
  EXPECT_EQ(read.squares[1].size_mm, 4);
  ASSERT_EQ(read.attached.size(), 1u);
  const AttachedBoard &a = read.attached[0], &b = board.attached[0];
  EXPECT_EQ(a.board.name, "wall");
  EXPECT_EQ(a.board.tags.size(), 2u);
  EXPECT_EQ(a.board.tag_size_mm, 30);
  EXPECT_TRUE(a.world_from_board.rotation.isApprox(b.world_from_board.rotation, 1e-14));
  EXPECT_EQ(a.world_from_board.translation, b.world_from_board.translation);
}

TEST(BoardParts, RefusesHostileJson) {
  const ScratchFolder scratch;
  const std::string good =
      R"({"name":"b","family":"tag36h11","border_cells":2,"width_mm":100,"height_mm":100,)"
      R"("tag_size_mm":24,"tags":[{"id":3,"center_mm":[0,0]}],)"
      R"("circles":[{"center_mm":[30,30],"diameter_mm":10,"color":"red"}],)"
      R"("squares":[{"center_mm":[-40,-40],"size_mm":5}],)"
      R"("attached":[{"name":"w","width_mm":50,"height_mm":50,"tag_size_mm":20,)"
      R"("tags":[{"id":7,"center_mm":[0,0]}],"rotation":[1,0,0,0],"translation":[0,0,20]}]})";
  const auto read = [&](const std::string& text) {
    std::ofstream(scratch.folder / "board.json", std::ios::binary) << text;
    return ReadBoard(scratch.folder / "board.json");
  };
  EXPECT_EQ(read(good).attached.at(0).board.tags.at(0).id, 7);
  const std::vector<std::pair<std::string, std::string>> changes = {
      {R"("border_cells":2)", R"("border_cells":7)"},
      {R"("border_cells":2)", R"("border_cells":1.5)"},
      {R"("color":"red")", R"("color":"puce")"},
      {R"("color":"red")", R"("color":3)"},
      {R"("color":"red")", R"("colour":"red")"},
      {R"("diameter_mm":10)", R"("diameter_mm":-10)"},
      {R"("diameter_mm":10)", R"("diameter_mm":1e999)"},
      {R"("diameter_mm":10,)", ""},
      {R"([30,30])", R"([30])"},
      {R"("size_mm":5)", R"("size_mm":"5")"},
      {R"([-40,-40])", R"({"x":-40})"},
      {R"("rotation":[1,0,0,0])", R"("rotation":[0,0,0,0])"},
      {R"("rotation":[1,0,0,0])", R"("rotation":[2,0,0,0])"},
      {R"("rotation":[1,0,0,0],)", ""},
      {R"("translation":[0,0,20])", R"("translation":[0,0])"},
      {R"("translation":[0,0,20])", R"("translation":[0,0,20],"family":"tag25h9")"},
      {R"("translation":[0,0,20])", R"("translation":[0,0,20],"attached":[])"},
      {R"("id":7)", R"("id":3)"},
      {R"("tag_size_mm":20,)", ""},
      {R"("squares":[{)", R"("squares":[7,{)"},
      {R"("family":"tag36h11",)", ""},
  };
  for (const auto& [from, to] : changes) {
    std::string text = good;
    ASSERT_NE(text.find(from), std::string::npos) << from;
    text.replace(text.find(from), from.size(), to);
    EXPECT_THROW(read(text), Error) << text;
  }
  for (size_t length = 0; length < good.size(); ++length) {
    EXPECT_THROW(read(good.substr(0, length)), Error) << length;
  }
}

}  // namespace
}  // namespace lfm
