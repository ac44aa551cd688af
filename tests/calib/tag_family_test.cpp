// SPDX-License-Identifier: BSD-3-Clause
#include "calib/tag_family.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "calib/board.h"
#include "calib/tag_detection.h"
#include "core/error.h"

namespace lfm {
namespace {

// Four tags, two of them turned, as close together as the board allows; ids from both ends of the
// family.
Board FourTags(const std::string& name, int border_cells) {
  const TagFamily family(name, border_cells, "test");
  Board board;
  board.name = name;
  board.family = name;
  board.border_cells = border_cells;
  const double cell = 3;
  board.tag_size_mm = cell * family.cells_per_side();
  const double pitch = cell * (family.cells_across() + 2 * family.quiet_cells());
  board.width_mm = board.height_mm = 2 * pitch + 4 * cell;
  for (int i = 0; i < 4; ++i) {
    BoardTag tag;
    tag.id = i < 2 ? i : family.count() - 4 + i;
    tag.center_mm = {(i % 2 - 0.5) * pitch, (i / 2 - 0.5) * pitch};
    tag.rotation = i % 2 * std::numbers::pi / 2;
    board.tags.push_back(tag);
  }
  return board;
}

void ExpectDetectedFromItsPicture(const Board& board) {
  constexpr double kPixelsPerMm = 2.5;
  constexpr double kCorner_abs = 0.7;  // px; the detector's own accuracy on coded values
  const Image drawing = DrawBoard(board, kPixelsPerMm);
  TagDetector detector(board.family, board.border_cells);
  const std::vector<TagDetection> tags = detector.Detect(drawing);
  ASSERT_EQ(tags.size(), 4u) << board.family;
  for (const TagDetection& tag : tags) {
    const auto on_board = std::find_if(board.tags.begin(), board.tags.end(),
                                       [&](const BoardTag& t) { return t.id == tag.id; });
    ASSERT_NE(on_board, board.tags.end()) << board.family << " " << tag.id;
    const auto corners = board.TagCorners(*on_board);
    for (int c = 0; c < 4; ++c) {
      const Eigen::Vector2d expected((corners[c].x() + board.width_mm / 2) * kPixelsPerMm - 0.5,
                                     (board.height_mm / 2 - corners[c].y()) * kPixelsPerMm - 0.5);
      EXPECT_LT((tag.corners[c] - expected).norm(), kCorner_abs)
          << board.family << " " << tag.id << " corner " << c;
    }
  }
}

class EveryFamily : public testing::TestWithParam<std::string> {};

TEST_P(EveryFamily, IsDetectedFromItsOwnPicture) {
  ExpectDetectedFromItsPicture(FourTags(GetParam(), 1));
}

INSTANTIATE_TEST_SUITE_P(TagFamily, EveryFamily, testing::ValuesIn(TagFamily::Names()),
                         [](const auto& family) { return family.param; });

TEST(TagFamily, ABorderOfTwoCellsIsDetectedAsSuchOnly) {
  for (const char* name : {"tag36h11", "tag25h9", "tag16h5"}) {
    const Board board = FourTags(name, 2);
    ExpectDetectedFromItsPicture(board);
    // A short code is found anywhere: four detections say nothing there.
    if (board.family == "tag16h5") continue;
    TagDetector narrow(board.family, 1);
    EXPECT_LT(narrow.Detect(DrawBoard(board, 2.5)).size(), 4u) << name;
  }
}

TEST(TagFamily, RefusesUnknownNamesAndBorders) {
  EXPECT_THROW(TagFamily("tag99h9", 1, "test"), Error);
  EXPECT_THROW(TagFamily("", 1, "test"), Error);
  EXPECT_THROW(TagFamily("tag36h11", 0, "test"), Error);
  EXPECT_THROW(TagFamily("tag36h11", 3, "test"), Error);
  EXPECT_THROW(TagFamily("tagStandard41h12", 2, "test"), Error);
}

}  // namespace
}  // namespace lfm
