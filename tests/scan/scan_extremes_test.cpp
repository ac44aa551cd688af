// SPDX-License-Identifier: BSD-3-Clause
// Scans that hold little, nothing, or lies.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "scan/known_rig.h"
#include "tests/scan/ball_studio.h"

namespace lfm {
namespace {

using testing::BallOnPlate;
using testing::ErrorOf;
using testing::HitPlate;
using testing::HitSphere;
using testing::kBallCenter;
using testing::kBallRadius;
using testing::LitSample;
using testing::MedianDistanceToBall;
using testing::RenderFrame;
using testing::RenderSettings;
using testing::RunScan;
using testing::Studio;
using testing::TheStudio;

std::string ReasonOf(const ScanResult& result, const std::string& id) {
  for (const ScanFailure& f : result.rejected) {
    if (f.id == id) return f.reason;
  }
  return "";
}

double ShareOff(const PointCloud& cloud, double mm) {
  size_t off = 0;
  for (const Eigen::Vector3d& p : cloud.points) {
    const double distance =
        std::min(std::abs((p - kBallCenter).norm() - kBallRadius), std::abs(p.z()));
    off += distance > mm ? 1 : 0;
  }
  return static_cast<double>(off) / static_cast<double>(std::max<size_t>(1, cloud.points.size()));
}

TEST(ScanExtremes, AScanOfNothingAndASaturatedOneAreNamed) {
  Studio studio = TheStudio();
  studio.Rescan(1, HitPlate);
  RenderSettings glaring;
  glaring.ambient = 2;
  studio.Rescan(2, BallOnPlate, glaring);
  RenderSettings dark;
  dark.light = 0;
  studio.Rescan(3, BallOnPlate, dark);
  const ScanResult result = RunScan(studio);
  ASSERT_EQ(result.scans.size(), 1U);
  EXPECT_NE(ReasonOf(result, "scan-1").find("no point above the platform"), std::string::npos);
  EXPECT_NE(ReasonOf(result, "scan-2").find("saturated"), std::string::npos)
      << ReasonOf(result, "scan-2");
  EXPECT_NE(ReasonOf(result, "scan-3").find("do not show the projector's light"), std::string::npos)
      << ReasonOf(result, "scan-3");
  EXPECT_LT(MedianDistanceToBall(result.points), 0.08);
}

TEST(ScanExtremes, EverythingSaturatedIsAnErrorThatSaysSo) {
  Studio studio = TheStudio();
  RenderSettings glaring;
  glaring.ambient = 2;
  for (size_t i = 0; i < 4; ++i) studio.Rescan(i, BallOnPlate, glaring);
  EXPECT_NE(ErrorOf(studio).find("saturated; expose less"), std::string::npos) << ErrorOf(studio);
}

TEST(ScanExtremes, OneScanAndTwoScansAreEnough) {
  for (size_t count : {1U, 2U}) {
    Studio studio = TheStudio();
    studio.capture.scanner->scans.resize(count);
    const ScanResult result = RunScan(studio);
    ASSERT_EQ(result.scans.size(), count);
    EXPECT_GT(result.points.points.size(), 1500U);
    EXPECT_LT(MedianDistanceToBall(result.points), 0.08);
    EXPECT_LT(ShareOff(result.points, 1), 0.002);
    if (count == 1) {
      EXPECT_FALSE(result.registration.kept);
    }
  }
}

/// What a scan of a mirror ball gathers: where the ball is, the plate's picture in it.
std::vector<std::vector<LitSample>> TraceMirrorBall(const RigCalibration& rig, const Pose& pose) {
  const Pose projector_from_world = rig.projector_from_camera * pose;
  const Eigen::Vector3d eye = pose.Center(), lamp = projector_from_world.Center();
  std::vector<std::vector<LitSample>> pixels;
  for (int y = 0; y < rig.camera.height; ++y) {
    for (int x = 0; x < rig.camera.width; ++x) {
      pixels.emplace_back();
      Eigen::Vector3d origin = eye;
      Eigen::Vector3d direction = pose.rotation.transpose() * Unproject(rig.camera, {x, y});
      const auto ball = HitSphere(origin, direction, kBallCenter, kBallRadius);
      if (ball) {
        origin += ball->distance * direction;
        direction -= 2 * direction.dot(ball->normal) * ball->normal;
      }
      const auto plate = HitPlate(origin, direction);
      if (!plate) continue;
      const Eigen::Vector3d point = origin + plate->distance * direction;
      if (point.head<2>().norm() > 110) continue;
      const Eigen::Vector3d from_lamp = (point - lamp).normalized();
      const auto source = Project(rig.projector, projector_from_world * point);
      const bool lit = source && rig.projector.Contains(*source) &&
                       !HitSphere(lamp, from_lamp, kBallCenter, kBallRadius);
      pixels.back().push_back(
          {lit ? *source : Eigen::Vector2d(0, 0), lit ? -0.9 * from_lamp.z() : 0.0, 0.01});
    }
  }
  return pixels;
}

TEST(ScanExtremes, AMirrorBallLeavesFewFalsePoints) {
  Studio studio = TheStudio();
  const auto columns = MakePatternSequence(512, 384, PatternRows::kWithout);
  RenderSettings settings;
  settings.samples = 1;
  for (size_t i = 0; i < 4; ++i) {
    const auto traced = TraceMirrorBall(studio.rig, studio.calib.scans[i].camera_from_world);
    for (size_t f = 0; f < columns.patterns.size(); ++f) {
      studio.files[studio.capture.scanner->scans[i].frames[f]] =
          RenderFrame(traced, studio.rig.camera, columns, static_cast<int>(f), settings);
    }
  }
  // Either nothing is left, and that is said, or little is.
  try {
    const ScanResult result = RunScan(studio);
    for (const Eigen::Vector3d& p : result.points.points) EXPECT_TRUE(p.allFinite());
    RecordProperty("points", static_cast<int>(result.points.points.size()));
    EXPECT_LT(result.points.points.size(), 1500U);
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("can be used"), std::string::npos) << error.what();
  }
}

TEST(KnownRig, ReplacesPlacementsAndIsHeld) {
  Studio studio = TheStudio();
  studio.capture.scanner->placements.clear();
  EXPECT_NE(ErrorOf(studio).find("or give a known rig"), std::string::npos);
  const KnownRig known{studio.rig.camera, studio.rig.projector, studio.rig.projector_from_camera,
                       "rig.json"};
  const ScanResult result = RunScan(studio, {}, known);
  EXPECT_EQ(result.rig.source, RigSource::kGiven);
  EXPECT_EQ(result.rig.projector.fx, studio.rig.projector.fx);
  EXPECT_EQ(result.rig.projector_from_camera.translation,
            studio.rig.projector_from_camera.translation);
  EXPECT_EQ(result.scans.size(), 4U);
  EXPECT_LT(MedianDistanceToBall(result.points), 0.06);

  // The same out of the manifest.
  studio.capture.scanner->projector = studio.rig.projector;
  studio.capture.scanner->projector_from_camera = studio.rig.projector_from_camera;
  const ScanResult manifest = RunScan(studio);
  EXPECT_EQ(manifest.rig.source, RigSource::kGiven);
  EXPECT_EQ(manifest.points.points.size(), result.points.points.size());
}

TEST(KnownRig, ThatContradictsTheScansIsRefused) {
  const Studio& studio = TheStudio();
  KnownRig moved{studio.rig.camera, studio.rig.projector, studio.rig.projector_from_camera,
                 "old-rig.json"};
  // 3 mm: about 5 projector pixels.
  moved.projector_from_camera.translation.x() += 3;
  std::string error = ErrorOf(studio, moved);
  EXPECT_NE(error.find("old-rig.json: the known rig contradicts the scans"), std::string::npos)
      << error;
  EXPECT_EQ(error.find('\n'), std::string::npos);
  // Half a millimetre: just under a pixel.
  moved.projector_from_camera = studio.rig.projector_from_camera;
  moved.projector_from_camera.translation.x() += 0.6;
  error = ErrorOf(studio, moved);
  EXPECT_NE(error.find("contradicts"), std::string::npos) << error;

  KnownRig other_size{studio.rig.camera, studio.rig.projector, studio.rig.projector_from_camera,
                      "other.json"};
  other_size.projector.width = 1920;
  EXPECT_NE(ErrorOf(studio, other_size).find("1920 x 384"), std::string::npos);
  other_size.projector.width = studio.rig.projector.width;
  other_size.camera.height = 100;
  EXPECT_NE(ErrorOf(studio, other_size).find("other.json"), std::string::npos);
}

TEST(Scan, CornersAdjustTheCameraWithTheRest) {
  Studio studio = TheStudio();
  studio.ShowCorners(0.03, 3);
  // The calibration's camera and poses are a little off; the corners know better.
  studio.calib.cameras["scanner"].fx *= 1.002;
  studio.calib.cameras["scanner"].cx += 0.4;
  for (auto* poses : {&studio.calib.scans, &studio.calib.placements}) {
    for (PosedImage& posed : *poses) {
      posed.camera_from_world.translation += Eigen::Vector3d(0.1, -0.05, 0.8);
    }
  }
  const ScanResult result = RunScan(studio);
  EXPECT_NEAR(result.rig.camera.fx, studio.rig.camera.fx, 0.3);
  EXPECT_NEAR(result.rig.camera_rms_px, 0.03 * std::sqrt(2.0), 0.012);
  EXPECT_LT(MedianDistanceToBall(result.points), 0.06);
  ASSERT_EQ(result.scans.size(), 4U);
  for (size_t i = 0; i < 4; ++i) {
    const Pose truth = testing::TurnedPlatform(90.0 * static_cast<double>(i));
    EXPECT_LT((result.scans[i].camera_from_world.Center() - truth.Center()).norm(), 0.3);
  }
}

TEST(Scan, StatedSigmasAreThoseOfThePoints) {
  // Fewer samples a pixel make a raster that no lens makes.
  Studio studio(7);
  studio.ShowCorners(0.03, 4);
  const ScanResult result = RunScan(studio);
  const PointCloud& cloud = result.points;
  ASSERT_EQ(cloud.sigma_mm.size(), cloud.points.size());
  double sum = 0, count = 0;
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    const Eigen::Vector3d arm = cloud.points[i] - kBallCenter;
    // Away from silhouettes and from where the ball meets the plate.
    const Eigen::Vector3d n = arm.normalized();
    if (cloud.confidence[i] < 0.5F || cloud.points[i].z() < 15) continue;
    const double off = arm.dot(n) - kBallRadius;
    if (std::abs(off) > 0.5) continue;
    sum += std::pow(off / cloud.sigma_mm[i], 2);
    count += 1;
  }
  ASSERT_GT(count, 3000);
  EXPECT_GT(sum / count, 0.7);
  EXPECT_LT(sum / count, 1.4);
}

}  // namespace
}  // namespace lfm
