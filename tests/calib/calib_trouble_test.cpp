// SPDX-License-Identifier: BSD-3-Clause
// Calibrations of captures in which something is wrong: what is set aside, with which reason, and
// what is used for what it still gives.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "calib/calib.h"
#include "core/error.h"
#include "rendered_board.h"

namespace lfm {
namespace {

constexpr double kCenter_abs_mm = 0.15;

std::string MessageOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::string ReasonOf(const CalibResult& result, const std::string& id) {
  for (const RejectedImage& image : result.rejected) {
    if (image.id == id) return image.reason;
  }
  return "";
}

const PosedImage* FindPhoto(const CalibResult& result, const std::string& id) {
  for (const PosedImage& photo : result.photos) {
    if (photo.id == id) return &photo;
  }
  return nullptr;
}

CalibResult CalibrateAll(const RenderedCapture& rendered, const Board& board = DefaultBoard()) {
  return Calibrate(rendered.capture, board, rendered.Loader(), {}, SilentProgress());
}

// Pictures of `board` from poses of the test's choice.
RenderedCapture RenderPoses(const Board& board, const std::vector<Pose>& poses) {
  RenderedCapture rendered = RenderCapture(board, static_cast<int>(poses.size()), 0);
  rendered.poses = poses;
  const BoardPrint print(board);
  for (size_t i = 0; i < poses.size(); ++i) {
    RenderSettings settings;
    settings.seed = static_cast<uint32_t>(50 + i);
    rendered.pictures[i] = RenderBoard(print, rendered.camera, poses[i], settings);
  }
  return rendered;
}

void Paste(const Image& from, int from_x, Image& to, int to_x, int columns) {
  for (int y = 0; y < to.height(); ++y) {
    for (int x = 0; x < columns; ++x) {
      for (int c = 0; c < 3; ++c) {
        to.At<uint8_t>(to_x + x, y, c) = from.At<uint8_t>(from_x + x, y, c);
      }
    }
  }
}

TEST(CalibrateTrouble, MirroredIsSetAsideWithTheReason) {
  RenderedCapture rendered = RenderCapture(DefaultBoard(), 5, 0);
  Image& picture = rendered.pictures[4];
  const Image original = picture;
  for (int x = 0; x < picture.width(); ++x) Paste(original, picture.width() - 1 - x, picture, x, 1);
  const CalibResult result = CalibrateAll(rendered);
  EXPECT_NE(ReasonOf(result, "photo_4").find("mirrored"), std::string::npos)
      << ReasonOf(result, "photo_4");
  EXPECT_EQ(result.photos.size(), 4u);
}

TEST(CalibrateTrouble, BlurredIsUsedWhereItStillGivesSomething) {
  RenderedCapture rendered = RenderCapture(DefaultBoard(), 6, 0);
  const auto blurred = [&](size_t i, int radius) {
    const Image sharp = rendered.pictures[i];
    for (int y = 0; y < sharp.height(); ++y) {
      for (int x = 0; x < sharp.width(); ++x) {
        float sum = 0;
        for (int dx = -radius; dx <= radius; ++dx) {
          sum += LinearFromSrgb(sharp.At<uint8_t>(std::clamp(x + dx, 0, sharp.width() - 1), y, 0) /
                                255.0f);
        }
        const float mean = SrgbFromLinear(sum / static_cast<float>(2 * radius + 1));
        for (int c = 0; c < 3; ++c) {
          rendered.pictures[i].At<uint8_t>(x, y, c) = static_cast<uint8_t>(std::lround(mean * 255));
        }
      }
    }
  };
  blurred(4, 1);
  blurred(5, 25);
  const CalibResult result = CalibrateAll(rendered);
  const PosedImage* little = FindPhoto(result, "photo_4");
  ASSERT_TRUE(little) << ReasonOf(result, "photo_4");
  EXPECT_LT((little->camera_from_world.Center() - rendered.poses[4].Center()).norm(), 0.5);
  EXPECT_NE(ReasonOf(result, "photo_5"), "");
}

TEST(CalibrateTrouble, HalfSeenPlatformIsUsed) {
  std::vector<Pose> poses = PosesAround(6);
  const Eigen::Vector3d eye(60, -260, 260);
  poses[5] = LookAt(eye, {95, 0, 0}, {0, 0, 1});
  const RenderedCapture rendered = RenderPoses(DefaultBoard(), poses);
  const CalibResult result = CalibrateAll(rendered);
  const PosedImage* half = FindPhoto(result, "photo_5");
  ASSERT_TRUE(half) << ReasonOf(result, "photo_5");
  EXPECT_LT(half->tags, 20);
  EXPECT_LT((half->camera_from_world.Center() - eye).norm(), kCenter_abs_mm);
}

// A second print of a few tags lies beside the platform: the larger part counts.
TEST(CalibrateTrouble, DuplicatedTagsArePassedOver) {
  RenderedCapture rendered = RenderCapture(DefaultBoard(), 5, 0);
  const Pose pose = LookAt({-60, -250, 250}, {-60, 0, 0}, {0, 0, 1});
  rendered.poses[4] = pose;
  rendered.pictures[4] = RenderBoard(BoardPrint(DefaultBoard()), rendered.camera, pose);
  // The platform's left part stands in the picture's right half; a copy of a strip goes to the
  // left.
  const Image copy = RenderBoard(BoardPrint(DefaultBoard()), rendered.camera,
                                 LookAt({200, -250, 250}, {140, 0, 0}, {0, 0, 1}));
  Paste(copy, 0, rendered.pictures[4], 0, 90);
  const CalibResult result = CalibrateAll(rendered);
  const PosedImage* photo = FindPhoto(result, "photo_4");
  ASSERT_TRUE(photo) << ReasonOf(result, "photo_4");
  EXPECT_LT((photo->camera_from_world.Center() - pose.Center()).norm(), 2 * kCenter_abs_mm);
}

TEST(CalibrateTrouble, AnotherBoardOfTheSameTagsIsSetAside) {
  RenderedCapture rendered = RenderCapture(DefaultBoard(), 6, 0);
  Board other = DefaultBoard();
  for (size_t i = 0; i < other.tags.size(); ++i) other.tags[i].id = static_cast<int>(i * 7 % 24);
  rendered.pictures[5] = RenderBoard(BoardPrint(other), rendered.camera, rendered.poses[5]);
  const CalibResult result = CalibrateAll(rendered);
  EXPECT_NE(ReasonOf(result, "photo_5").find("lie as on the board"), std::string::npos)
      << ReasonOf(result, "photo_5");
}

// Tags glued by hand on a plate that sags: both found, poses as good as on a flat print.
TEST(CalibrateTrouble, ImpreciseBentPlatformIsFoundFromItsPictures) {
  Board moved = DefaultBoard();
  for (size_t t = 0; t < moved.tags.size(); ++t) {
    moved.tags[t].center_mm += 0.25 * Eigen::Vector2d(std::sin(2.0 * t), std::cos(3.0 * t));
  }
  const Eigen::Vector3d bend(-1.2e-4, 0, 0);
  const RenderedCapture rendered =
      RenderCapture(moved, 14, 1, 0, {.hidden_share = 0.25, .bend_per_mm = bend});
  const CalibResult result = CalibrateAll(rendered);
  EXPECT_EQ(result.platform_model, "tags moved, bent");
  EXPECT_EQ(result.platform_trials.size(), 6u);
  EXPECT_NEAR(result.platform_shape.bend_per_mm.x(), bend.x(), 6e-6);
  ASSERT_EQ(result.platform_shape.shifts_mm.size(), BoardCorners(moved).size());
  for (size_t t = 0; t < moved.tags.size(); ++t) {
    const Eigen::Vector2d truth = moved.tags[t].center_mm - DefaultBoard().tags[t].center_mm;
    EXPECT_LT((result.platform_shape.shifts_mm[4 * t] - truth).norm(), 0.05) << t;
  }
  EXPECT_EQ(result.photos.size(), 15u);
  for (size_t i = 0; i < result.photos.size(); ++i) {
    EXPECT_LT((result.photos[i].camera_from_world.Center() - rendered.poses[i].Center()).norm(),
              kCenter_abs_mm)
        << i;
  }
  EXPECT_LT(result.reprojection_rms_px, 0.06);
}

TEST(CalibrateTrouble, TwoPhotographsAreNotEnough) {
  const RenderedCapture rendered = RenderCapture(DefaultBoard(), 2, 0);
  const std::string message = MessageOf([&] { CalibrateAll(rendered); });
  EXPECT_NE(message.find("2 usable training pictures"), std::string::npos) << message;
}

TEST(CalibrateTrouble, OnePhotographSufficesWhenTheCameraIsKnown) {
  RenderedCapture rendered = RenderCapture(DefaultBoard(), 1, 0);
  rendered.capture.cameras["photo"].intrinsics = rendered.camera;
  const CalibResult result = CalibrateAll(rendered);
  ASSERT_EQ(result.photos.size(), 1u);
  EXPECT_LT((result.photos[0].camera_from_world.Center() - rendered.poses[0].Center()).norm(),
            kCenter_abs_mm);
  EXPECT_TRUE(result.intrinsics_covariance.empty());
}

// One view of a plane says two things; four are asked, however often it is taken.
TEST(CalibrateTrouble, AllPhotographsFromOneSpotDoNotTellTheCamera) {
  const RenderedCapture rendered =
      RenderPoses(DefaultBoard(), std::vector<Pose>(6, PosesAround(5)[2]));
  const std::string message = MessageOf([&] { CalibrateAll(rendered); });
  EXPECT_NE(message.find("cannot be told from these pictures"), std::string::npos) << message;
  EXPECT_NE(message.find("add pictures from slanted directions"), std::string::npos) << message;
}

TEST(CalibrateTrouble, HeadOnPicturesDoNotTellTheFocalLength) {
  std::vector<Pose> poses;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d over(2.0 * i, 3.0 * (i % 3), 0);
    poses.push_back(LookAt(over + Eigen::Vector3d(0, 0, 380 + 10 * i), over, {0.1 * i, 1, 0}));
  }
  const RenderedCapture rendered = RenderPoses(DefaultBoard(), poses);
  const std::string message = MessageOf([&] { CalibrateAll(rendered); });
  EXPECT_NE(message.find("focal length"), std::string::npos) << message;
}

TEST(CalibrateTrouble, BoardOfOneTagPosesAKnownCamera) {
  Board board;
  board.name = "one";
  board.width_mm = board.height_mm = 220;
  board.tag_size_mm = 150;
  board.tags = {{.id = 3}};
  RenderedCapture rendered = RenderPoses(board, PosesAround(4));
  rendered.capture.cameras["photo"].intrinsics = rendered.camera;
  const CalibResult result = CalibrateAll(rendered, board);
  ASSERT_EQ(result.photos.size(), 4u);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(result.photos[i].corners, 4);
    EXPECT_LT((result.photos[i].camera_from_world.Center() - rendered.poses[i].Center()).norm(), 1);
  }
}

TEST(CalibrateTrouble, BoardOfOneTagCalibratesACameraOrSaysThatItCannot) {
  Board board;
  board.name = "one";
  board.width_mm = board.height_mm = 220;
  board.tag_size_mm = 150;
  board.tags = {{.id = 3}};
  const RenderedCapture rendered = RenderPoses(board, PosesAround(20));
  CalibResult result;
  const std::string message = MessageOf([&] { result = CalibrateAll(rendered, board); });
  if (!message.empty()) {
    EXPECT_NE(message.find("cannot be told"), std::string::npos) << message;
    return;
  }
  const double sigma = std::sqrt(result.intrinsics_covariance.at("photo")(0, 0));
  EXPECT_LT(std::abs(result.cameras.at("photo").fx - rendered.camera.fx), 6 + 4 * sigma);
  EXPECT_EQ(result.lens_terms.at("photo"), 1);
}

TEST(CalibrateTrouble, MetresForMillimetresAreNamedWithTheCure) {
  const RenderedCapture rendered = RenderCapture(DefaultBoard(), 3, 0);
  Board metres = DefaultBoard();
  metres.width_mm /= 1000, metres.height_mm /= 1000;
  metres.tag_size_mm /= 1000, metres.checker_square_mm /= 1000;
  for (BoardTag& tag : metres.tags) tag.center_mm /= 1000;
  const std::string message = MessageOf([&] { CalibrateAll(rendered, metres); });
  EXPECT_NE(message.find("tags of 0.024 mm"), std::string::npos) << message;
  EXPECT_NE(message.find("by 1000"), std::string::npos) << message;
}

// A phone and a second camera, half of the pictures each, and a third one that is known.
TEST(CalibrateTrouble, SeveralCamerasShareOnePlatform) {
  RenderedCapture rendered = RenderCapture(DefaultBoard(), 12, 0);
  Camera other = rendered.camera;
  other.fx = other.fy = 470, other.cx = 238, other.k1 = 0.03, other.k2 = 0;
  const BoardPrint print(DefaultBoard());
  rendered.capture.cameras["other"] = {480, 360, {}};
  rendered.capture.cameras["known"] = {480, 360, other};
  for (int i = 0; i < 12; i += 2) {
    rendered.capture.photos[i].camera = i < 8 ? "other" : "known";
    rendered.pictures[i] = RenderBoard(print, other, rendered.poses[i]);
  }
  const CalibResult result = CalibrateAll(rendered);
  ASSERT_EQ(result.cameras.size(), 3u);
  EXPECT_NEAR(result.cameras.at("photo").fx, rendered.camera.fx, 0.5);
  EXPECT_NEAR(result.cameras.at("other").fx, 470, 1);
  EXPECT_EQ(result.cameras.at("known").fx, 470);
  EXPECT_FALSE(result.lens_terms.contains("known"));
  EXPECT_EQ(result.intrinsics_covariance.size(), 2u);
  EXPECT_EQ(result.photos.size(), 12u);
  for (size_t i = 0; i < 12; ++i) {
    EXPECT_LT((result.photos[i].camera_from_world.Center() - rendered.poses[i].Center()).norm(),
              2 * kCenter_abs_mm)
        << i;
  }
}

}  // namespace
}  // namespace lfm
