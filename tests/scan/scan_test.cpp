// SPDX-License-Identifier: BSD-3-Clause
#include "scan/scan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "scan/scan_pictures.h"
#include "tests/scan/ball_studio.h"
#include "tests/scan/synthetic_rig.h"

namespace lfm {
namespace {

using testing::HitPlate;
using testing::HitSphere;
using testing::KnownRig;
using testing::RenderScan;
using testing::RenderSettings;
using testing::Surface;
using testing::SurfaceHit;
using testing::TiltedPlacements;
using testing::TurnedPlatform;

using testing::BallOnPlate;
using testing::ErrorOf;
using testing::kBallCenter;
using testing::kBallRadius;
using testing::MedianDistanceToBall;
using testing::RunScan;
using testing::Studio;
using testing::TheStudio;

TEST(Scan, BallIsMeasuredFromAllSides) {
  const ScanResult result = RunScan(TheStudio());
  EXPECT_EQ(result.scans.size(), 4U);
  EXPECT_TRUE(result.rejected.empty());
  ASSERT_GT(result.points.points.size(), 8000U);
  ASSERT_EQ(result.points.normals.size(), result.points.points.size());
  ASSERT_EQ(result.points.confidence.size(), result.points.points.size());
  EXPECT_LT(MedianDistanceToBall(result.points), 0.06);
  size_t far = 0, seen_from_behind = 0;
  double low = 1e9, high = -1e9;
  for (size_t i = 0; i < result.points.points.size(); ++i) {
    const Eigen::Vector3d& p = result.points.points[i];
    far += std::abs((p - kBallCenter).norm() - kBallRadius) > 1 ? 1 : 0;
    seen_from_behind += result.points.normals[i].dot(p - kBallCenter) < 0 ? 1 : 0;
    low = std::min(low, p.x());
    high = std::max(high, p.x());
    EXPECT_GT(p.z(), 0);
  }
  EXPECT_LE(far, result.points.points.size() / 1000);
  EXPECT_LE(seen_from_behind, result.points.points.size() / 1000);
  EXPECT_LT(low, kBallCenter.x() - 0.9 * kBallRadius);
  EXPECT_GT(high, kBallCenter.x() + 0.9 * kBallRadius);
  EXPECT_LT(result.rig.projector_rms_px, 0.12);
  EXPECT_NEAR(result.rig.camera_rms_px, 0.1, 1e-12);
  EXPECT_NEAR(result.rig.projector.fx, TheStudio().rig.projector.fx, 3);
}

TEST(Scan, TheNumberOfThreadsDoesNotMatter) {
  SetThreadCount(1);
  const ScanResult one = RunScan(TheStudio());
  SetThreadCount(4);
  const ScanResult four = RunScan(TheStudio());
  SetThreadCount(0);
  ASSERT_EQ(one.points.points.size(), four.points.points.size());
  for (size_t i = 0; i < one.points.points.size(); ++i) {
    ASSERT_EQ(one.points.points[i], four.points.points[i]);
    ASSERT_EQ(one.points.confidence[i], four.points.confidence[i]);
  }
  EXPECT_EQ(one.rig.condition, four.rig.condition);
}

TEST(Scan, AScanThatCannotBeReadIsSetAsideWithTheReason) {
  Studio studio = TheStudio();
  studio.files.erase(studio.capture.scanner->scans[1].frames[7]);
  studio.files[studio.capture.scanner->scans[2].frames[3]] =
      Image(10, 10, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  studio.files.erase(studio.capture.scanner->placements[4].frames[0]);
  studio.calib.scans.pop_back();
  // A photograph of the same id, set aside for a reason of its own.
  studio.calib.rejected.push_back({"scan-3", "photos/scan-3.png", "blurred"});
  studio.calib.rejected.push_back(
      {"scan-3", studio.capture.scanner->scans[3].frames[0], "no tag found"});
  const ScanResult result = RunScan(studio);
  ASSERT_EQ(result.scans.size(), 1U);
  EXPECT_EQ(result.scans[0].id, "scan-0");
  ASSERT_EQ(result.rejected.size(), 4U);
  EXPECT_EQ(result.rejected[0].id, "placement-4");
  EXPECT_EQ(result.rejected[1].id, "scan-1");
  EXPECT_NE(result.rejected[1].reason.find("scan-1/7.png"), std::string::npos);
  EXPECT_NE(result.rejected[2].reason.find("10 x 10"), std::string::npos);
  EXPECT_NE(result.rejected[3].reason.find("no tag found"), std::string::npos);
  EXPECT_LT(MedianDistanceToBall(result.points), 0.08);
}

TEST(Scan, PlacementOfAnotherSizeIsSetAsideWithTheReason) {
  Studio studio = TheStudio();
  for (const std::string& frame : studio.capture.scanner->placements[2].frames) {
    studio.files[frame] = Image(120, 90, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  }
  studio.capture.scanner->scans.resize(1);
  const ScanResult result = RunScan(studio);
  ASSERT_EQ(result.rejected.size(), 1U);
  EXPECT_EQ(result.rejected[0].id, "placement-2");
  EXPECT_NE(result.rejected[0].reason.find("120 x 90"), std::string::npos);
}

TEST(Scan, ACalibrationForPicturesOfAnotherSizeIsNamedBeforeAnyIsLoaded) {
  Studio studio = TheStudio();
  Camera& camera = studio.calib.cameras.at(studio.capture.scanner->camera);
  const std::string ours = std::to_string(camera.width) + " x " + std::to_string(camera.height);
  camera.width += 7;
  studio.files.clear();
  const std::string error = ErrorOf(studio);
  EXPECT_NE(error.find("\"" + studio.capture.scanner->camera + "\""), std::string::npos) << error;
  EXPECT_NE(error.find(std::to_string(camera.width) + " x "), std::string::npos) << error;
  EXPECT_NE(error.find(ours), std::string::npos) << error;
}

TEST(Scan, PlacementsOfWhichNoneCanBeUsedSayWhy) {
  Studio studio = TheStudio();
  for (const ScanSet& placement : studio.capture.scanner->placements) {
    for (const std::string& frame : placement.frames) {
      studio.files[frame] = Image(120, 90, 1, PixelType::kUint8, ColorEncoding::kSrgb);
    }
  }
  const std::string error = ErrorOf(studio);
  for (const char* part : {"only 0 of 5 placements", "placement-0", "120 x 90"}) {
    EXPECT_NE(error.find(part), std::string::npos) << error;
  }
}

TEST(Scan, WhatCannotWorkIsAnErrorThatSaysWhy) {
  // Roles without columns: said before a picture is read.
  for (const char* kind : {"scan_roles", "placement_roles"}) {
    Studio rows_only = TheStudio();
    Scanner& scanner = *rows_only.capture.scanner;
    (kind == std::string("scan_roles") ? scanner.scan_roles : scanner.placement_roles) = {
        "white", "black", "row-gray-0", "row-gray-0-inverse"};
    rows_only.files.clear();
    EXPECT_NE(ErrorOf(rows_only).find(std::string(kind) + ": names no column"), std::string::npos);
  }

  Studio no_scanner = TheStudio();
  no_scanner.capture.scanner.reset();
  EXPECT_NE(ErrorOf(no_scanner).find("no scanner"), std::string::npos);

  Studio no_placements = TheStudio();
  no_placements.capture.scanner->placements.clear();
  EXPECT_NE(ErrorOf(no_placements).find("tilted"), std::string::npos);

  Studio no_scans = TheStudio();
  no_scans.capture.scanner->scans.clear();
  EXPECT_NE(ErrorOf(no_scans).find("no scans"), std::string::npos);

  Studio unreadable = TheStudio();
  for (const ScanSet& scan : unreadable.capture.scanner->scans) {
    unreadable.files.erase(scan.frames[0]);
  }
  EXPECT_NE(ErrorOf(unreadable).find("none of the 4 scans"), std::string::npos);

  Studio other_size = TheStudio();
  other_size.calib.cameras["scanner"].width = 200;
  EXPECT_FALSE(ErrorOf(other_size).empty());

  Studio no_camera = TheStudio();
  no_camera.calib.cameras.clear();
  EXPECT_NE(ErrorOf(no_camera).find("lacks the scanner's camera"), std::string::npos);
}

TEST(Scan, PlacementsThatOnlyTurnTheEmptyPlatformAreRefused) {
  Studio studio = TheStudio();
  studio.capture.scanner->placements.clear();
  studio.calib.placements.clear();
  const auto both = MakePatternSequence(512, 384, PatternRows::kWith);
  for (int i = 0; i < 3; ++i) {
    studio.capture.scanner->placements.push_back(studio.Add("turned-" + std::to_string(i),
                                                            TurnedPlatform(50 * i), HitPlate, both,
                                                            studio.calib.placements));
  }
  EXPECT_NE(ErrorOf(studio).find("cannot be calibrated"), std::string::npos);
}

TEST(Scan, PatternsThatCannotBeDecodedAreRefusedBeforeAnyPictureIsLoaded) {
  std::vector<std::string> names = {"white", "black"};
  for (int i = 0; i < 8; ++i) names.push_back("column-phase-16-" + std::to_string(i));
  for (bool in_scans : {true, false}) {
    Studio studio = TheStudio();
    Scanner& scanner = *studio.capture.scanner;
    (in_scans ? scanner.scan_roles : scanner.placement_roles) = names;
    for (ScanSet& set : in_scans ? scanner.scans : scanner.placements) {
      set.frames.assign(names.size(), "absent.png");
    }
    const std::string error = ErrorOf(studio);
    EXPECT_NE(error.find("repeat"), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
}

TEST(Scan, TheBallIsMeasuredUnderEveryKindOfPattern) {
  for (const PatternScheme scheme :
       {PatternScheme::kGray, PatternScheme::kMultiPhase, PatternScheme::kStripe}) {
    PatternOptions options;
    options.scheme = scheme;
    const PatternSequence sequence = MakePatternSequence(512, 384, PatternRows::kWithout, options);
    Studio studio = TheStudio();
    Scanner& scanner = *studio.capture.scanner;
    scanner.scans.clear();
    studio.calib.scans.clear();
    scanner.scan_roles.clear();
    for (const Pattern& p : sequence.patterns) scanner.scan_roles.push_back(PatternName(p));
    scanner.scans.push_back(
        studio.Add("other", TurnedPlatform(0), BallOnPlate, sequence, studio.calib.scans));
    const ScanResult result = RunScan(studio);
    EXPECT_GT(result.points.points.size(), 2000U) << static_cast<int>(scheme);
    EXPECT_LT(MedianDistanceToBall(result.points), 0.08) << static_cast<int>(scheme);
  }
}

TEST(Scan, AnEmptyPlatformIsAnError) {
  Studio studio = TheStudio();
  studio.capture.scanner->scans.clear();
  studio.calib.scans.clear();
  const auto columns = MakePatternSequence(512, 384, PatternRows::kWithout);
  studio.capture.scanner->scans.push_back(
      studio.Add("empty", TurnedPlatform(0), HitPlate, columns, studio.calib.scans));
  EXPECT_NE(ErrorOf(studio).find("no point above the platform"), std::string::npos);
}

TEST(ScanPictures, ShowTheDecodedScan) {
  const Studio& studio = TheStudio();
  const ScanPictures pictures = DrawScan(studio.capture, 0, studio.Loader(), {});
  for (const Image* image : {&pictures.columns, &pictures.phase, &pictures.confidence}) {
    EXPECT_EQ(image->width(), studio.rig.camera.width);
    EXPECT_EQ(image->height(), studio.rig.camera.height);
    EXPECT_EQ(image->channels(), 3);
    const auto [low, high] =
        std::minmax_element(image->Data<uint8_t>(), image->Data<uint8_t>() + image->size());
    EXPECT_LT(*low, 40);
    EXPECT_GT(*high, 200);
  }
  EXPECT_THROW(DrawScan(studio.capture, 4, studio.Loader(), {}), Error);
  EXPECT_THROW(DrawScan(studio.capture, -1, studio.Loader(), {}), Error);
}

}  // namespace
}  // namespace lfm
