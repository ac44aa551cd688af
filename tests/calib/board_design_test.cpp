// SPDX-License-Identifier: BSD-3-Clause
#include "calib/board_design.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "calib/board_advice.h"
#include "calib/circle_match.h"
#include "calib/tag_family.h"
#include "core/error.h"

namespace lfm {
namespace {

TEST(BoardDesign, DefaultsGiveTheDefaultBoard) {
  const Board board = DefaultBoard();
  EXPECT_EQ(board.family, "tag36h11");
  EXPECT_EQ(board.width_mm, 220);
  EXPECT_EQ(board.height_mm, 220);
  EXPECT_EQ(board.tag_size_mm, 24);
  EXPECT_EQ(board.checker_columns, 10);
  EXPECT_EQ(board.checker_rows, 10);
  EXPECT_EQ(board.checker_square_mm, 15);
  ASSERT_EQ(board.tags.size(), 24u);
  // Numbered row by row from the top left.
  EXPECT_EQ(board.tags[0].center_mm, Eigen::Vector2d(-93, 93));
  EXPECT_EQ(board.tags[1].center_mm, Eigen::Vector2d(-62, 93));
  EXPECT_EQ(board.tags[7].center_mm, Eigen::Vector2d(-93, 62));
  EXPECT_EQ(board.tags[8].center_mm, Eigen::Vector2d(93, 62));
  EXPECT_EQ(board.tags[23].center_mm, Eigen::Vector2d(93, -93));
  for (size_t i = 0; i < board.tags.size(); ++i) {
    EXPECT_EQ(board.tags[i].id, static_cast<int>(i));
    EXPECT_EQ(board.tags[i].rotation, 0);
  }
}

// Board's advice on scans, taken.
TEST(BoardDesign, CirclesBetweenTagsAndASmallerCheckerFit) {
  BoardDesign design;
  design.circles = 12;
  design.checker_columns = design.checker_rows = 8;
  EXPECT_EQ(DesignBoard(design).circles.size(), 12u);
}

TEST(BoardDesign, EveryLayoutIsValid) {
  BoardDesign grid;
  grid.layout = BoardLayout::kGrid;
  grid.first_id = 50;
  const Board tags = DesignBoard(grid);
  EXPECT_EQ(tags.tags.size(), 49u);
  EXPECT_EQ(tags.tags[0].id, 50);
  EXPECT_EQ(tags.checker_columns, 0);
  BoardDesign circles;
  circles.layout = BoardLayout::kCircles;
  for (int count = 4; count <= 24; ++count) {
    circles.circles = count;
    const Board board = DesignBoard(circles);
    EXPECT_EQ(board.circles.size(), static_cast<size_t>(count));
    EXPECT_TRUE(board.tags.empty());
    EXPECT_FALSE(CirclesAreAmbiguous(board.circles));
  }
}

TEST(BoardDesign, EveryFamilyCanBeLaidOut) {
  for (const std::string& name : TagFamily::Names()) {
    BoardDesign design;
    design.family = name;
    const TagFamily family(name, 1, "test");
    // As large as the default's tags, quiet zone and all.
    design.tag_size_mm = 24.0 * family.cells_per_side() / family.cells_across();
    EXPECT_NO_THROW(DesignBoard(design)) << name;
  }
}

TEST(BoardDesign, WhatDoesNotFitIsRefused) {
  const std::vector<std::pair<std::string, std::function<void(BoardDesign&)>>> faults = {
      {"id 30 is not in tag16h5", [](BoardDesign& d) { d.family = "tag16h5", d.first_id = 10; }},
      {"unknown tag family", [](BoardDesign& d) { d.family = "tag"; }},
      {"closer than one cell to tags[",
       [](BoardDesign& d) { d.tag_pitch_mm = 26.5, d.checker_square_mm = 12; }},
      {"plate's edge", [](BoardDesign& d) { d.tag_size_mm = 30; }},
      {"plate's edge", [](BoardDesign& d) { d.tag_columns = 8; }},
      {"to the checker", [](BoardDesign& d) { d.checker_square_mm = 17; }},
      {"checker", [](BoardDesign& d) { d.checker_rows = 1; }},
      {"no room", [](BoardDesign& d) { d.layout = BoardLayout::kGrid, d.circles = 4; }},
      {"circles[0]", [](BoardDesign& d) { d.circles = 4; }},
      {"no room",
       [](BoardDesign& d) { d.layout = BoardLayout::kCircles, d.circle_diameter_mm = 200; }},
      {"four or more", [](BoardDesign& d) { d.layout = BoardLayout::kCircles, d.circles = 3; }},
      {"tag-size", [](BoardDesign& d) { d.tag_size_mm = std::nan(""); }},
      {"width", [](BoardDesign& d) { d.width_mm = std::numeric_limits<double>::infinity(); }},
      {"tag-columns", [](BoardDesign& d) { d.tag_columns = 0; }},
  };
  for (const auto& [expected, spoil] : faults) {
    BoardDesign design;
    spoil(design);
    try {
      DesignBoard(design);
      ADD_FAILURE() << expected;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(expected), std::string::npos)
          << expected << " in: " << error.what();
    }
  }
}

bool Advises(const Board& board, double mm_per_pixel, const std::string& what) {
  for (const std::string& line : AdviseOnBoard(board, mm_per_pixel)) {
    if (line.find(what) != std::string::npos) return true;
  }
  return false;
}

TEST(BoardAdvice, NamesWhatACameraCannotSee) {
  EXPECT_TRUE(AdviseOnBoard(DefaultBoard(), 0.25).empty());
  EXPECT_TRUE(Advises(DefaultBoard(), 1.1, "a tag's cell is 2.7 pixels"));
  EXPECT_TRUE(Advises(DefaultBoard(), 1.8, "a checker square is 8.3 pixels"));
  EXPECT_FALSE(Advises(DefaultBoard(), 1.1, "checker square"));
  BoardDesign circles;
  circles.layout = BoardLayout::kCircles;
  EXPECT_EQ(AdviseOnBoard(DesignBoard(circles), 0.25).size(), 1u);
  EXPECT_TRUE(Advises(DesignBoard(circles), 0.25, "not a gray scanner's"));
  EXPECT_TRUE(Advises(DesignBoard(circles), 0.8, "a circle is 17.5 pixels"));
  Board one = DefaultBoard();
  one.tags.resize(1);
  EXPECT_TRUE(Advises(one, 0.25, "only 1 tag"));
  one.checker_columns = one.checker_rows = 0;
  EXPECT_TRUE(Advises(one, 0.25, "has 4 corners"));
  EXPECT_THROW(AdviseOnBoard(one, 0), Error);
  EXPECT_THROW(AdviseOnBoard(one, std::nan("")), Error);
}

// The checker looks the same after half a turn, so the circles alone must tell.
TEST(BoardDesign, NoTurnLaysACircleOnOneOfItsColour) {
  for (const int count : {4, 6, 8, 12, 16}) {
    BoardDesign design;
    design.layout = BoardLayout::kCircles;
    design.circles = count;
    const std::vector<BoardCircle> circles = DesignBoard(design).circles;
    for (const BoardCircle& a : circles) {
      Eigen::Vector2d turned = a.center_mm;
      for (int quarter = 1; quarter < 4; ++quarter) {
        turned = Eigen::Vector2d(-turned.y(), turned.x());
        for (const BoardCircle& b : circles) {
          if ((turned - b.center_mm).norm() > a.diameter_mm) continue;
          EXPECT_NE(a.color, b.color) << count << " circles, quarter " << quarter;
        }
      }
    }
  }
}

}  // namespace
}  // namespace lfm
