// SPDX-License-Identifier: BSD-3-Clause
#include "calib/board.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "core/error.h"

namespace lfm {
namespace {

class BoardFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("lfm_board_" + std::to_string(testing::UnitTest::GetInstance()->random_seed()) +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path Write(const std::string& text) const {
    const std::filesystem::path file = folder_ / "hostile.json";
    std::ofstream(file, std::ios::binary) << text;
    return file;
  }
  std::filesystem::path folder_;
};

Board TwoTags() {
  Board board = DefaultBoard();
  board.tags.resize(2);
  return board;
}

TEST(Board, DefaultIsValidAndHasQuietZones) {
  const Board board = DefaultBoard();
  EXPECT_NO_THROW(ValidateBoard(board, "default"));
  EXPECT_EQ(board.tags.size(), 24u);
  EXPECT_EQ(board.CheckerCorners().size(), 81u);
  const BoardPrint print(board);
  const double cell = board.tag_size_mm / 8;
  for (const BoardTag& tag : board.tags) {
    for (double along = -15; along <= 15; along += 0.7) {
      for (const double off : {12 + 0.02, 12 + cell - 0.02}) {
        for (const Eigen::Vector2d& d :
             {Eigen::Vector2d(along, off), Eigen::Vector2d(along, -off),
              Eigen::Vector2d(off, along), Eigen::Vector2d(-off, along)}) {
          EXPECT_EQ(print.Value(tag.center_mm + d), 1) << tag.id << " " << d.transpose();
        }
      }
    }
  }
}

TEST(Board, TagCornersTurnCounterClockwise) {
  Board board = TwoTags();
  BoardTag tag;
  tag.center_mm = {10, 20};
  const auto upright = board.TagCorners(tag);
  EXPECT_TRUE(upright[0].isApprox(Eigen::Vector3d(-2, 32, 0)));
  EXPECT_TRUE(upright[1].isApprox(Eigen::Vector3d(22, 32, 0)));
  EXPECT_TRUE(upright[2].isApprox(Eigen::Vector3d(22, 8, 0)));
  EXPECT_TRUE(upright[3].isApprox(Eigen::Vector3d(-2, 8, 0)));
  tag.rotation = std::numbers::pi / 2;
  const auto turned = board.TagCorners(tag);
  for (int c = 0; c < 4; ++c) EXPECT_LT((turned[c] - upright[(c + 3) % 4]).norm(), 1e-12);
}

TEST(Board, CheckerCornersLieBetweenFourAlternatingSquares) {
  const Board board = DefaultBoard();
  const BoardPrint print(board);
  const auto corners = board.CheckerCorners();
  EXPECT_TRUE(corners[0].isApprox(Eigen::Vector3d(-60, -60, 0)));
  EXPECT_TRUE(corners[1].isApprox(Eigen::Vector3d(-45, -60, 0)));
  for (const Eigen::Vector3d& c : corners) {
    const auto at = [&](double x, double y) { return print.Value({c.x() + x, c.y() + y}); };
    EXPECT_EQ(at(1, 1), at(-1, -1));
    EXPECT_EQ(at(-1, 1), at(1, -1));
    EXPECT_NE(at(1, 1), at(1, -1));
  }
  EXPECT_EQ(print.Value({-74, -74}), 0) << "the lowest square is black";
}

TEST(BoardPrint, OutsideThePlateGivesNoAnswer) {
  const BoardPrint print(DefaultBoard());
  EXPECT_EQ(print.Value({110.01, 0}), -1);
  EXPECT_EQ(print.Value({0, -110.01}), -1);
  EXPECT_EQ(print.Value({109.99, 109.99}), 1);
  EXPECT_EQ(print.Value({std::nan(""), 0}), -1);
  EXPECT_EQ(print.Value({std::numeric_limits<double>::infinity(), 0}), -1);
}

TEST(BoardPrint, MeanValueIsTheMeanOfValues) {
  Board board = DefaultBoard();
  board.circles.push_back({.center_mm = {95, 0}, .diameter_mm = 12});
  const BoardPrint print = BoardPrint::WithMovedTags(board);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-118, 118), step(-1, 1);
  std::vector<float> x, y;
  for (int i = 0; i < 101; ++i) {
    x.push_back(static_cast<float>(step(random)));
    y.push_back(static_cast<float>(step(random)));
  }
  int mixed = 0;
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector2d center(place(random), place(random));
    Eigen::Matrix2d slope;
    slope << step(random), step(random), step(random), step(random);
    double sum = 0;
    for (size_t k = 0; k < x.size(); ++k) {
      sum += std::max(0.0, print.Value(center + slope * Eigen::Vector2d(x[k], y[k])));
    }
    const double mean = sum / static_cast<double>(x.size());
    mixed += mean > 0 && mean < 1 ? 1 : 0;
    // A place within a millionth of an edge may fall on its other side.
    EXPECT_NEAR(print.MeanValue(center, slope, x, y), mean, 1.01 / static_cast<double>(x.size()));
  }
  EXPECT_GT(mixed, 500);
  const Eigen::Vector2d nowhere(std::numeric_limits<double>::quiet_NaN(), 1e300);
  EXPECT_EQ(print.MeanValue(nowhere, Eigen::Matrix2d::Identity(), x, y), 0);
}

TEST(BoardPrint, TurnedTagShowsTheSameCells) {
  Board board = TwoTags();
  board.checker_columns = board.checker_rows = 0;
  board.tags[0] = {.id = 5, .center_mm = {-85, 40}, .rotation = 0};
  board.tags[1] = {.id = 6, .center_mm = {0, 95}, .rotation = 0};
  const BoardPrint upright(board);
  board.tags[0].rotation = 0.3;
  const BoardPrint turned(board);
  const Eigen::Vector2d x(std::cos(0.3), std::sin(0.3)), y(-x.y(), x.x());
  int ink = 0;
  for (double u = -11.5; u < 12; u += 1) {
    for (double v = -11.5; v < 12; v += 1) {
      const double expected = upright.Value(board.tags[0].center_mm + Eigen::Vector2d(u, v));
      EXPECT_EQ(turned.Value(board.tags[0].center_mm + u * x + v * y), expected);
      ink += expected == 0;
    }
  }
  EXPECT_GT(ink, 28 * 9) << "at least the black border";
}

TEST(BoardPrint, DrawingAgreesWithValues) {
  const Board board = DefaultBoard();
  const BoardPrint print(board);
  const Image drawing = DrawBoard(board, 2);
  ASSERT_EQ(drawing.width(), 440);
  ASSERT_EQ(drawing.height(), 440);
  for (int y = 1; y < 440; y += 7) {
    for (int x = 1; x < 440; x += 5) {
      const double value = print.Value({(x + 0.5) / 2 - 110, 110 - (y + 0.5) / 2});
      EXPECT_EQ(drawing.At<uint8_t>(x, y), value > 0 ? 255 : 0);
    }
  }
  EXPECT_THROW(DrawBoard(board, 0), Error);
  EXPECT_THROW(DrawBoard(board, std::nan("")), Error);
}

TEST(Board, RejectsEveryViolation) {
  const double nan = std::nan("");
  const std::vector<std::pair<std::string, std::function<void(Board&)>>> violations = {
      {"family", [](Board& b) { b.family = "tag99h9"; }},
      {"width_mm", [](Board& b) { b.width_mm = 0; }},
      {"width_mm", [&](Board& b) { b.height_mm = nan; }},
      {"tag_size_mm", [](Board& b) { b.tag_size_mm = -24; }},
      {"tag_size_mm", [](Board& b) { b.tag_size_mm = std::numeric_limits<double>::infinity(); }},
      {"at least one tag", [](Board& b) { b.tags.clear(); }},
      {"id 587", [](Board& b) { b.tags[3].id = 587; }},
      {"id -1", [](Board& b) { b.tags[3].id = -1; }},
      {"used twice", [](Board& b) { b.tags[3].id = 7; }},
      {"finite", [&](Board& b) { b.tags[3].center_mm.x() = nan; }},
      {"rotation", [&](Board& b) { b.tags[3].rotation = 10; }},
      {"to tags[", [](Board& b) { b.tags[1].center_mm.x() -= 5; }},
      {"to tags[", [](Board& b) { b.tags[1].center_mm = b.tags[0].center_mm; }},
      {"edge", [](Board& b) { b.tags[0].center_mm.y() += 3; }},
      {"edge", [](Board& b) { b.tags[0].rotation = 0.5; }},
      {"to the checker", [](Board& b) { b.tags[3].center_mm.y() -= 4; }},
      {"to the checker",
       [](Board& b) {
         b.tags[3].center_mm = {0, 0};
       }},
      {"checker", [](Board& b) { b.checker_columns = 0; }},
      {"checker", [](Board& b) { b.checker_rows = 1; }},
      {"checker", [](Board& b) { b.checker_rows = -4; }},
      {"square_mm", [&](Board& b) { b.checker_square_mm = nan; }},
      {"larger than the plate", [](Board& b) { b.checker_square_mm = 23; }},
  };
  for (size_t i = 0; i < violations.size(); ++i) {
    Board board = DefaultBoard();
    violations[i].second(board);
    try {
      ValidateBoard(board, "board.json");
      ADD_FAILURE() << "violation " << i << " (" << violations[i].first << ") was accepted";
    } catch (const Error& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find(violations[i].first), std::string::npos) << i << ": " << message;
      EXPECT_EQ(message.find("board.json"), 0u) << message;
    }
  }
}

TEST_F(BoardFiles, RoundTrip) {
  Board board = DefaultBoard();
  board.tags[4].rotation = std::numbers::pi;
  board.tags[7].rotation = -std::numbers::pi / 2;
  WriteBoard(board, folder_ / "board.json");
  const Board read = ReadBoard(folder_ / "board.json");
  EXPECT_EQ(read.name, board.name);
  EXPECT_EQ(read.family, board.family);
  EXPECT_EQ(read.width_mm, board.width_mm);
  EXPECT_EQ(read.height_mm, board.height_mm);
  EXPECT_EQ(read.tag_size_mm, board.tag_size_mm);
  EXPECT_EQ(read.checker_columns, board.checker_columns);
  EXPECT_EQ(read.checker_rows, board.checker_rows);
  EXPECT_EQ(read.checker_square_mm, board.checker_square_mm);
  ASSERT_EQ(read.tags.size(), board.tags.size());
  for (size_t i = 0; i < read.tags.size(); ++i) {
    EXPECT_EQ(read.tags[i].id, board.tags[i].id);
    EXPECT_EQ(read.tags[i].center_mm, board.tags[i].center_mm);
    EXPECT_NEAR(read.tags[i].rotation, board.tags[i].rotation, 1e-15);
  }
}

TEST_F(BoardFiles, RefusesHostileJson) {
  const std::string good =
      R"({"name":"b","family":"tag36h11","width_mm":100,"height_mm":100,"tag_size_mm":24,)"
      R"("tags":[{"id":3,"center_mm":[0,0]}]})";
  EXPECT_EQ(ReadBoard(Write(good)).tags.at(0).id, 3);
  const std::vector<std::pair<std::string, std::string>> changes = {
      {R"("name":"b")", R"("name":7)"},
      {R"("name":"b")", R"("nmae":"b")"},
      {R"("name":"b")", R"("name":"b","extra":1)"},
      {R"("width_mm":100)", R"("width_mm":"100")"},
      {R"("width_mm":100)", R"("width_mm":1e999)"},
      {R"("id":3)", R"("id":3.5)"},
      {R"("id":3)", R"("id":99999999999999999999)"},
      {R"([0,0])", R"([0])"},
      {R"([0,0])", R"([0,0,0])"},
      {R"([0,0])", R"([0,null])"},
      {R"([0,0])", R"([0,0],"colour":"red")"},
      {R"("tags":[{)", R"("tags":{"a":{)"},
      {R"("tags":[{)", R"("checker":{"columns":10},"tags":[{)"},
      {R"("tags":[{)", R"("checker":[],"tags":[{)"},
  };
  for (const auto& [from, to] : changes) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    EXPECT_THROW(ReadBoard(Write(text)), Error) << text;
  }
  for (size_t length = 0; length < good.size(); ++length) {
    EXPECT_THROW(ReadBoard(Write(good.substr(0, length))), Error) << length;
  }
  EXPECT_THROW(ReadBoard(folder_ / "missing.json"), Error);
  EXPECT_THROW(ReadBoard(folder_), Error);
}

}  // namespace
}  // namespace lfm
