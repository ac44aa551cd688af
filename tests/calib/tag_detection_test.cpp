// SPDX-License-Identifier: BSD-3-Clause
#include "calib/tag_detection.h"

#include <gtest/gtest.h>

#include <map>

#include "calib/board.h"
#include "calib/board_match.h"
#include "rendered_board.h"

namespace lfm {
namespace {

// Half a pixel of bias must not pass.
constexpr double kDetectionBias_abs_px = 0.05;

TEST(TagDetection, DrawnBoardIsFoundWithItsCornersInOrder) {
  const Board board = DefaultBoard();
  constexpr double kPixelsPerMm = 4;
  const Image drawing = DrawBoard(board, kPixelsPerMm);
  TagDetector detector(board.family);
  const std::vector<TagDetection> tags = detector.Detect(drawing);
  ASSERT_EQ(tags.size(), board.tags.size());
  for (size_t i = 0; i < tags.size(); ++i) {
    ASSERT_EQ(tags[i].id, board.tags[i].id);
    const auto corners = board.TagCorners(board.tags[i]);
    for (int c = 0; c < 4; ++c) {
      const Eigen::Vector2d expected((corners[c].x() + 110) * kPixelsPerMm - 0.5,
                                     (110 - corners[c].y()) * kPixelsPerMm - 0.5);
      EXPECT_LT((tags[i].corners[c] - expected).norm(), 1) << "tag " << i << " corner " << c;
    }
  }
}

TEST(TagDetection, ObliqueNoisyViewsHaveNoHalfPixelBias) {
  const Board board = DefaultBoard();
  const Camera camera = ScaleCamera(SmallCamera(), 1.5);
  TagDetector detector(board.family);
  for (const Pose& pose : PosesAround(3)) {
    const auto tags = detector.Detect(RenderBoard(board, camera, pose));
    EXPECT_GE(tags.size(), 20u);
    Eigen::Vector2d bias = Eigen::Vector2d::Zero();
    for (const TagDetection& tag : tags) {
      ASSERT_LT(tag.id, 24);
      const auto corners = board.TagCorners(board.tags[tag.id]);
      for (int c = 0; c < 4; ++c) {
        const auto projected = Project(camera, pose * corners[c]);
        ASSERT_TRUE(projected);
        const Eigen::Vector2d error = tag.corners[c] - *projected;
        // A corner now and then is off by pixels; the search for corners mends that.
        bias += error.cwiseMin(1).cwiseMax(-1) / (4.0 * static_cast<double>(tags.size()));
      }
    }
    EXPECT_LT(bias.norm(), kDetectionBias_abs_px) << bias.transpose();
  }
}

TEST(TagDetection, FindsNothingInBlankOrTinyPictures) {
  TagDetector detector("tag36h11");
  EXPECT_TRUE(detector.Detect(Image(200, 100, 3, PixelType::kUint8, ColorEncoding::kSrgb)).empty());
  EXPECT_TRUE(detector.Detect(Image(1, 1, 1, PixelType::kUint8, ColorEncoding::kSrgb)).empty());
  EXPECT_TRUE(
      detector.Detect(Image(3, 300, 4, PixelType::kFloat32, ColorEncoding::kLinear)).empty());
}

std::vector<TagDetection> PerfectDetections(const Board& board, double scale,
                                            const Eigen::Vector2d& shift) {
  std::vector<TagDetection> detections;
  for (const BoardTag& tag : board.tags) {
    TagDetection detection;
    detection.id = tag.id;
    const auto corners = board.TagCorners(tag);
    for (int c = 0; c < 4; ++c) {
      detection.corners[c] = shift + scale * Eigen::Vector2d(corners[c].x(), -corners[c].y());
    }
    detections.push_back(detection);
  }
  return detections;
}

std::string ReasonOf(const std::variant<BoardMatch, BoardMismatch>& match) {
  const BoardMismatch* mismatch = std::get_if<BoardMismatch>(&match);
  return mismatch ? mismatch->reason : "";
}

TEST(BoardMatch, DropsTheTagThatLiesWrong) {
  const Board board = DefaultBoard();
  auto detections = PerfectDetections(board, 2, {300, 300});
  for (Eigen::Vector2d& corner : detections[5].corners) corner.x() += 90;
  const auto match = MatchBoard(board, detections);
  ASSERT_TRUE(std::holds_alternative<BoardMatch>(match)) << ReasonOf(match);
  EXPECT_EQ(std::get<BoardMatch>(match).tags, 23);
  EXPECT_EQ(std::get<BoardMatch>(match).pixels.size(), 92u);
}

TEST(BoardMatch, TellsWhyAPictureIsUseless) {
  const Board board = DefaultBoard();
  EXPECT_NE(ReasonOf(MatchBoard(board, {})).find("no tag36h11 tag"), std::string::npos);

  auto foreign = PerfectDetections(board, 2, {300, 300});
  for (TagDetection& tag : foreign) tag.id += 100;
  EXPECT_NE(ReasonOf(MatchBoard(board, foreign)).find("not on the board"), std::string::npos);

  auto two = PerfectDetections(board, 2, {300, 300});
  const auto second = PerfectDetections(board, 2, {900, 300});
  two.insert(two.end(), second.begin(), second.end());
  EXPECT_NE(ReasonOf(MatchBoard(board, two)).find("two boards"), std::string::npos);

  auto shuffled = PerfectDetections(board, 2, {300, 300});
  for (size_t i = 0; i < shuffled.size(); ++i) {
    shuffled[i].id = board.tags[(i * 7 + 3) % shuffled.size()].id;
  }
  EXPECT_NE(ReasonOf(MatchBoard(board, shuffled)).find("two boards"), std::string::npos);
}

TEST(BoardMatch, OneTagIsEnoughForAHomography) {
  const Board board = DefaultBoard();
  auto detections = PerfectDetections(board, 2, {300, 300});
  detections.resize(1);
  const auto match = MatchBoard(board, detections);
  ASSERT_TRUE(std::holds_alternative<BoardMatch>(match)) << ReasonOf(match);
  EXPECT_EQ(std::get<BoardMatch>(match).tags, 1);
}

}  // namespace
}  // namespace lfm
