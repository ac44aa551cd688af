// SPDX-License-Identifier: BSD-3-Clause
#include "calib/calib.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "calib/calib_pictures.h"
#include "core/error.h"
#include "core/parallel.h"
#include "error_message.h"
#include "rendered_board.h"

namespace lfm {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kFocal_rel = 5e-4;
constexpr double kPrincipalPoint_abs_px = 0.25;
constexpr double kCenter_abs_mm = 0.12;
constexpr double kRotation_abs_deg = 0.02;
constexpr double kReprojection_abs_px = 0.04;

void ExpectPoseNear(const Pose& found, const Pose& expected, const std::string& id) {
  EXPECT_LT((found.Center() - expected.Center()).norm(), kCenter_abs_mm) << id;
  EXPECT_LT(RotationAngle(found.rotation, expected.rotation), kRotation_abs_deg * kDegree) << id;
}

bool SameBits(const Camera& a, const Camera& b) {
  return a.fx == b.fx && a.fy == b.fy && a.cx == b.cx && a.cy == b.cy && a.k1 == b.k1 &&
         a.k2 == b.k2 && a.k3 == b.k3 && a.p1 == b.p1 && a.p2 == b.p2;
}

bool SameBits(const Pose& a, const Pose& b) {
  return a.rotation == b.rotation && a.translation == b.translation;
}

CalibResult CalibrateRendered(const RenderedCapture& rendered, const CalibOptions& options = {}) {
  return Calibrate(rendered.capture, DefaultBoard(), rendered.Loader(), options, SilentProgress());
}

std::string ReasonOf(const CalibResult& result, const std::string& id) {
  for (const RejectedImage& image : result.rejected) {
    if (image.id == id) return image.reason;
  }
  return "";
}

TEST(Calibrate, RecoversIntrinsicsAndPosesFromRenderedPictures) {
  const RenderedCapture rendered = RenderCapture(DefaultBoard(), 10, 2);
  const CalibResult result = CalibrateRendered(rendered);
  for (const RejectedImage& image : result.rejected) ADD_FAILURE() << image.id << image.reason;
  const Camera& camera = result.cameras.at("photo");
  const Camera& truth = rendered.camera;
  EXPECT_NEAR(camera.fx, truth.fx, kFocal_rel * truth.fx);
  EXPECT_NEAR(camera.fy, truth.fy, kFocal_rel * truth.fy);
  EXPECT_NEAR(camera.cx, truth.cx, kPrincipalPoint_abs_px);
  EXPECT_NEAR(camera.cy, truth.cy, kPrincipalPoint_abs_px);
  // The polynomial's coefficients trade with each other: compare the lens where it was used.
  for (const double x : {-0.4, 0.0, 0.4}) {
    for (const double y : {-0.3, 0.0, 0.3}) {
      const Eigen::Vector3d ray(x, y, 1);
      EXPECT_LT((*Project(camera, ray) - *Project(truth, ray)).norm(), 0.25) << x << " " << y;
    }
  }
  ASSERT_EQ(result.photos.size(), 12u);
  for (size_t i = 0; i < result.photos.size(); ++i) {
    const PosedImage& photo = result.photos[i];
    EXPECT_EQ(photo.id, rendered.capture.photos[i].id);
    EXPECT_EQ(photo.split, i < 10 ? PhotoSplit::kTrain : PhotoSplit::kTest);
    ExpectPoseNear(photo.camera_from_world, rendered.poses[i], photo.id);
    EXPECT_GE(photo.tags, 8);
    EXPECT_GE(photo.corners, 60);
    EXPECT_LT(photo.reprojection_rms_px, kReprojection_abs_px);
    EXPECT_TRUE(photo.covariance.isApprox(photo.covariance.transpose()));
    const double sigma_mm = std::sqrt(photo.covariance.bottomRightCorner<3, 3>().trace());
    EXPECT_GT(sigma_mm, 1e-4);
    EXPECT_LT(sigma_mm, kCenter_abs_mm);
  }
  EXPECT_LT(result.reprojection_rms_px, kReprojection_abs_px);
  EXPECT_GT(result.corner_noise_px, 0.001);
  EXPECT_LT(result.corner_noise_px, result.reprojection_rms_px);
}

TEST(Calibrate, TestPicturesDoNotInfluenceIntrinsicsNorThreadsAnything) {
  RenderedCapture rendered = RenderCapture(DefaultBoard(), 4, 2);
  SetThreadCount(1);
  const CalibResult one = CalibrateRendered(rendered);
  SetThreadCount(0);
  const CalibResult all = CalibrateRendered(rendered);
  ASSERT_EQ(one.photos.size(), 6u);
  ASSERT_EQ(all.photos.size(), 6u);
  EXPECT_TRUE(SameBits(one.cameras.at("photo"), all.cameras.at("photo")));
  for (int i = 0; i < 6; ++i) {
    EXPECT_TRUE(SameBits(one.photos[i].camera_from_world, all.photos[i].camera_from_world));
    EXPECT_EQ(one.photos[i].covariance, all.photos[i].covariance);
  }

  rendered.pictures[4] = rendered.pictures[0];
  rendered.pictures[5] = Image(480, 360, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  const CalibResult changed = CalibrateRendered(rendered);
  EXPECT_TRUE(SameBits(one.cameras.at("photo"), changed.cameras.at("photo")));
  ASSERT_EQ(changed.photos.size(), 5u);
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE(SameBits(one.photos[i].camera_from_world, changed.photos[i].camera_from_world));
  }
  ExpectPoseNear(changed.photos[4].camera_from_world, rendered.poses[0], "copied test picture");
}

TEST(Calibrate, SetsAsideWhatCannotBeUsedWithTheReason) {
  RenderedCapture rendered = RenderCapture(DefaultBoard(), 11, 0);
  Board other = DefaultBoard();
  for (BoardTag& tag : other.tags) tag.id += 50;
  Board reversed = DefaultBoard();
  for (BoardTag& tag : reversed.tags) tag.id = 23 - tag.id;
  const Camera& camera = rendered.camera;
  rendered.pictures[4] = Image(480, 360, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  rendered.pictures[5] = RenderBoard(other, camera, rendered.poses[5]);
  rendered.pictures[6] = Image(640, 360, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  const Image turned = RenderBoard(reversed, camera, rendered.poses[7]);
  for (int y = 0; y < 360; ++y) {
    for (int x = 240; x < 480; ++x) {
      for (int c = 0; c < 3; ++c) {
        rendered.pictures[7].At<uint8_t>(x, y, c) = turned.At<uint8_t>(x, y, c);
      }
    }
  }
  Board larger = DefaultBoard();
  larger.tag_size_mm = 26;
  larger.checker_columns = larger.checker_rows = 0;
  rendered.pictures[10] = RenderBoard(larger, camera, rendered.poses[10]);
  const ImageLoader in_memory = rendered.Loader();
  const ImageLoader loader = [&](const std::string& file) -> Image {
    if (file == "photo_8.png") throw Error("photo_8.png: missing");
    if (file == "photo_9.png") throw Error("photo_9.png: truncated");
    return in_memory(file);
  };
  const CalibResult result =
      Calibrate(rendered.capture, DefaultBoard(), loader, {}, SilentProgress());
  EXPECT_NE(ReasonOf(result, "photo_4").find("no tag36h11 tag"), std::string::npos);
  EXPECT_NE(ReasonOf(result, "photo_5").find("not on the board"), std::string::npos);
  EXPECT_NE(ReasonOf(result, "photo_6").find("640x360"), std::string::npos);
  EXPECT_NE(ReasonOf(result, "photo_7").find("two boards"), std::string::npos)
      << ReasonOf(result, "photo_7");
  EXPECT_EQ(ReasonOf(result, "photo_8"), "photo_8.png: missing");
  EXPECT_EQ(ReasonOf(result, "photo_9"), "photo_9.png: truncated");
  EXPECT_NE(ReasonOf(result, "photo_10"), "");
  ASSERT_EQ(result.photos.size(), 4u);
  for (int i = 0; i < 4; ++i) {
    ExpectPoseNear(result.photos[i].camera_from_world, rendered.poses[i], result.photos[i].id);
  }
}

TEST(Calibrate, OnePhotographIsNotEnough) {
  const RenderedCapture rendered = RenderCapture(DefaultBoard(), 1, 0);
  const std::string message = MessageOf([&] { CalibrateRendered(rendered); });
  EXPECT_NE(message.find("at least three are needed"), std::string::npos) << message;
  EXPECT_NE(message.find("photo"), std::string::npos) << message;
}

TEST(Calibrate, NothingToCalibrateIsAnError) {
  Capture capture;
  capture.cameras["photo"] = {480, 360, {}};
  const std::string message = MessageOf([&] {
    Calibrate(
        capture, DefaultBoard(), [](const std::string&) { return Image(); }, {}, SilentProgress());
  });
  EXPECT_NE(message.find("no pictures"), std::string::npos) << message;
}

TEST(Calibrate, OptionsOutOfRangeAreRefused) {
  const RenderedCapture rendered = RenderCapture(DefaultBoard(), 0, 0);
  CalibOptions options;
  options.robust_scale_px = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(MessageOf([&] { CalibrateRendered(rendered, options); }).find("robust-scale-px"),
            std::string::npos);
}

TEST(Calibrate, HeadOnPicturesDoNotTellTheFocalLength) {
  std::vector<Pose> poses;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d over(2.0 * i, 3.0 * (i % 3), 0);
    poses.push_back(LookAt(over + Eigen::Vector3d(0, 0, 380 + 10 * i), over, {0.1 * i, 1, 0}));
  }
  const RenderedCapture rendered = RenderPoses(DefaultBoard(), poses, 4);
  const std::string message = MessageOf([&] { CalibrateRendered(rendered); });
  EXPECT_NE(message.find("focal length"), std::string::npos) << message;
}

TEST(Calibrate, ScansAndPlacementsCalibrateTheScannersCamera) {
  const Board board = DefaultBoard();
  RenderedCapture rendered = RenderCapture(board, 6, 0);
  Capture capture = rendered.capture;
  Scanner scanner;
  scanner.camera = "scanner";
  scanner.scan_roles = {"black", "white"};
  scanner.placement_roles = {"white"};
  for (int i = 0; i < 3; ++i) {
    const std::string id = std::to_string(i);
    scanner.scans.push_back({"scan_" + id, {"missing.png", "photo_" + id + ".png"}, {}});
    scanner.placements.push_back(
        {"placement_" + id, {"photo_" + std::to_string(i + 3) + ".png"}, {}});
  }
  capture.photos.clear();
  capture.cameras["scanner"] = capture.cameras["photo"];
  capture.cameras.erase("photo");
  capture.scanner = scanner;
  const CalibResult result = Calibrate(capture, board, rendered.Loader(), {}, SilentProgress());
  EXPECT_TRUE(result.photos.empty());
  ASSERT_EQ(result.scans.size(), 3u);
  ASSERT_EQ(result.placements.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(result.scans[i].camera, "scanner");
    ExpectPoseNear(result.scans[i].camera_from_world, rendered.poses[i], result.scans[i].id);
    ExpectPoseNear(result.placements[i].camera_from_world, rendered.poses[i + 3],
                   result.placements[i].id);
  }

  capture.scanner->scan_roles = {"black", "column-gray-0"};
  const std::string message =
      MessageOf([&] { Calibrate(capture, board, rendered.Loader(), {}, SilentProgress()); });
  EXPECT_NE(message.find("scan_roles"), std::string::npos) << message;
}

TEST(Calibrate, KnownIntrinsicsAreHeldAndTwoPicturesThenSuffice) {
  RenderedCapture rendered = RenderCapture(DefaultBoard(), 2, 0);
  rendered.capture.cameras["photo"].intrinsics = rendered.camera;
  const CalibResult result = CalibrateRendered(rendered);
  EXPECT_TRUE(SameBits(result.cameras.at("photo"), rendered.camera));
  ASSERT_EQ(result.photos.size(), 2u);
  for (int i = 0; i < 2; ++i) {
    ExpectPoseNear(result.photos[i].camera_from_world, rendered.poses[i], result.photos[i].id);
  }
}

TEST(DrawCalibration, MarksFoundCornersAndRefusesAnotherSize) {
  const RenderedCapture rendered = RenderCapture(DefaultBoard(), 1, 0);
  PosedImage image;
  image.file = "photo_0.png";
  image.camera = "photo";
  image.camera_from_world = rendered.poses[0];
  const Image drawing =
      DrawCalibration(rendered.pictures[0], DefaultBoard(), rendered.camera, {}, image);
  ASSERT_EQ(drawing.width(), 480);
  ASSERT_EQ(drawing.channels(), 3);
  int green = 0;
  for (int y = 0; y < 360; ++y) {
    for (int x = 0; x < 480; ++x) {
      green += drawing.At<uint8_t>(x, y, 1) > 180 && drawing.At<uint8_t>(x, y, 0) < 120;
    }
  }
  EXPECT_GT(green, 60);
  Image small(100, 100, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  EXPECT_THROW(DrawCalibration(small, DefaultBoard(), rendered.camera, {}, image), Error);
}

}  // namespace
}  // namespace lfm
