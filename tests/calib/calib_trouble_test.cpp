// SPDX-License-Identifier: BSD-3-Clause
// Calibrations of captures in which something is wrong: what is set aside, with which reason, and
// what is used for what it still gives.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/calib.h"
#include "error_message.h"
#include "rendered_board.h"

namespace lfm {
namespace {

constexpr double kCenter_abs_mm = 0.15;

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

RenderedCapture RenderPoses(const Board& board, const std::vector<Pose>& poses) {
  return RenderPoses(board, poses, static_cast<int>(poses.size()), {});
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

Image Mirrored(const Image& picture) {
  Image mirrored = picture;
  for (int x = 0; x < picture.width(); ++x) {
    Paste(picture, picture.width() - 1 - x, mirrored, x, 1);
  }
  return mirrored;
}

// Each row of linear light averaged over 2 radius + 1 pixels.
Image BlurredSideways(const Image& sharp, int radius) {
  Image blurred = sharp;
  for (int y = 0; y < sharp.height(); ++y) {
    for (int x = 0; x < sharp.width(); ++x) {
      float sum = 0;
      for (int dx = -radius; dx <= radius; ++dx) {
        const int from = std::clamp(x + dx, 0, sharp.width() - 1);
        sum += LinearFromSrgb(sharp.At<uint8_t>(from, y, 0) / 255.0f);
      }
      const float mean = SrgbFromLinear(sum / static_cast<float>(2 * radius + 1));
      for (int c = 0; c < 3; ++c) {
        blurred.At<uint8_t>(x, y, c) = static_cast<uint8_t>(std::lround(mean * 255));
      }
    }
  }
  return blurred;
}

// Four good photographs, and one of each trouble.
TEST(CalibrateTrouble, UsesWhatStillGivesSomethingAndNamesTheRest) {
  enum { kMirrored = 4, kBlurredALittle, kBlurredAway, kHalfSeen, kDuplicated, kOtherBoard, kAll };
  const Board board = DefaultBoard();
  std::vector<Pose> poses = PosesAround(kAll);
  const Eigen::Vector3d half_seen_from(60, -260, 260);
  poses[kHalfSeen] = LookAt(half_seen_from, {95, 0, 0}, {0, 0, 1});
  poses[kDuplicated] = LookAt({-60, -250, 250}, {-60, 0, 0}, {0, 0, 1});
  RenderedCapture rendered = RenderPoses(board, poses);
  std::vector<Image>& pictures = rendered.pictures;
  pictures[kMirrored] = Mirrored(pictures[kMirrored]);
  pictures[kBlurredALittle] = BlurredSideways(pictures[kBlurredALittle], 1);
  pictures[kBlurredAway] = BlurredSideways(pictures[kBlurredAway], 25);
  // A second print of a few tags lies left of the platform: the larger part counts.
  const Image copy =
      RenderBoard(board, rendered.camera, LookAt({200, -250, 250}, {140, 0, 0}, {0, 0, 1}));
  Paste(copy, 0, pictures[kDuplicated], 0, 90);
  Board other = board;
  for (size_t i = 0; i < other.tags.size(); ++i) other.tags[i].id = static_cast<int>(i * 7 % 24);
  pictures[kOtherBoard] = RenderBoard(other, rendered.camera, poses[kOtherBoard]);

  const CalibResult result = CalibrateAll(rendered);
  const auto reason = [&](int i) { return ReasonOf(result, rendered.capture.photos[i].id); };
  EXPECT_NE(reason(kMirrored).find("mirrored"), std::string::npos) << reason(kMirrored);
  EXPECT_NE(reason(kBlurredAway), "");
  EXPECT_NE(reason(kOtherBoard).find("lie as on the board"), std::string::npos)
      << reason(kOtherBoard);
  EXPECT_EQ(result.rejected.size(), 3u);
  const auto center_error_mm = [&](int i) {
    const PosedImage* photo = FindPhoto(result, rendered.capture.photos[i].id);
    if (!photo) ADD_FAILURE() << i << ": " << reason(i);
    return photo ? (photo->camera_from_world.Center() - poses[i].Center()).norm() : 0;
  };
  for (int i = 0; i < 4; ++i) EXPECT_LT(center_error_mm(i), kCenter_abs_mm) << i;
  EXPECT_LT(center_error_mm(kBlurredALittle), 0.5);
  EXPECT_LT(center_error_mm(kHalfSeen), 2 * kCenter_abs_mm);
  const PosedImage* half_seen = FindPhoto(result, rendered.capture.photos[kHalfSeen].id);
  ASSERT_TRUE(half_seen);
  EXPECT_LT(half_seen->tags, 20);
  EXPECT_LT(center_error_mm(kDuplicated), 2 * kCenter_abs_mm);
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

// One view of a plane says two things of a camera, four are asked; where the lens bends lines, the
// distortion says the rest, badly. However often the picture is taken, what comes out is refused or
// right within its stated uncertainty.
TEST(CalibrateTrouble, AllPhotographsFromOneSpotTellNoMoreThanTheySay) {
  const RenderedCapture rendered =
      RenderPoses(DefaultBoard(), std::vector<Pose>(4, PosesAround(5)[2]));
  CalibResult result;
  const std::string message = MessageOf([&] { result = CalibrateAll(rendered); });
  if (!message.empty()) {
    EXPECT_NE(message.find("cannot be told from these pictures"), std::string::npos) << message;
    EXPECT_NE(message.find("add pictures from slanted directions"), std::string::npos) << message;
    return;
  }
  const double sigma = std::sqrt(result.intrinsics_covariance.at("photo")(0, 0));
  EXPECT_GT(sigma, 1);
  EXPECT_LT(std::abs(result.cameras.at("photo").fx - rendered.camera.fx), 4 * sigma) << sigma;
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
  for (const RejectedImage& image : result.rejected) ADD_FAILURE() << image.id << image.reason;
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
  RenderedCapture rendered = RenderCapture(DefaultBoard(), 10, 0);
  Camera other = rendered.camera;
  other.fx = other.fy = 470, other.cx = 238, other.k1 = 0.03, other.k2 = 0;
  rendered.capture.cameras["other"] = {480, 360, {}};
  rendered.capture.cameras["known"] = {480, 360, other};
  for (int i = 0; i < 10; i += 2) {
    rendered.capture.photos[i].camera = i < 8 ? "other" : "known";
    rendered.pictures[i] = RenderBoard(DefaultBoard(), other, rendered.poses[i]);
  }
  const CalibResult result = CalibrateAll(rendered);
  ASSERT_EQ(result.cameras.size(), 3u);
  EXPECT_NEAR(result.cameras.at("photo").fx, rendered.camera.fx, 0.5);
  EXPECT_NEAR(result.cameras.at("other").fx, 470, 1);
  EXPECT_EQ(result.cameras.at("known").fx, 470);
  EXPECT_FALSE(result.lens_terms.contains("known"));
  EXPECT_EQ(result.intrinsics_covariance.size(), 2u);
  EXPECT_EQ(result.photos.size(), 10u);
  for (size_t i = 0; i < 10; ++i) {
    EXPECT_LT((result.photos[i].camera_from_world.Center() - rendered.poses[i].Center()).norm(),
              2 * kCenter_abs_mm)
        << i;
  }
}

}  // namespace
}  // namespace lfm
