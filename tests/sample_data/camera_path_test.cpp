// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/camera_path.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "calib/board.h"
#include "core/error.h"
#include "sample_data/scan_rig.h"
#include "sample_data/subject.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;

class CameraPathTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    bust_ = new Subject(MakeBust(2.0, 1));
    stations_ = new std::vector<CameraStation>(
        MakeCameraPath(MakePhotoCamera(960, 720), bust_->mesh, CameraPathOptions()));
  }
  static void TearDownTestSuite() {
    delete bust_;
    delete stations_;
  }
  static Subject* bust_;
  static std::vector<CameraStation>* stations_;
  const Camera camera_ = MakePhotoCamera(960, 720);
};
Subject* CameraPathTest::bust_ = nullptr;
std::vector<CameraStation>* CameraPathTest::stations_ = nullptr;

TEST_F(CameraPathTest, KeepsTheStatedRanges) {
  ASSERT_EQ(stations_->size(), 120u);
  double min_roll = 1e9, max_roll = -1e9, lowest = 90, highest = 0;
  for (const CameraStation& s : *stations_) {
    EXPECT_GE(s.elevation_deg, 10);
    EXPECT_LE(s.elevation_deg, 85);
    lowest = std::min(lowest, s.elevation_deg);
    highest = std::max(highest, s.elevation_deg);
    const V3 up = s.camera_from_world.rotation * V3::UnitZ();
    const double roll = std::atan2(up.x(), -up.y()) / kDegree;
    min_roll = std::min(min_roll, roll);
    max_roll = std::max(max_roll, roll);
  }
  EXPECT_LT(lowest, 14);
  EXPECT_GT(highest, 78);
  EXPECT_LT(min_roll, -25);
  EXPECT_GT(max_roll, 25);
}

TEST_F(CameraPathTest, FramesTheWholeObjectAtTheStatedScale) {
  double mean_height = 0;
  for (const CameraStation& s : *stations_) {
    double top = 1e9, bottom = -1e9;
    V3 up = s.camera_from_world.rotation * V3::UnitZ();
    up.z() = 0;
    const Eigen::Vector2d along = up.head<2>().normalized();
    for (const V3& p : bust_->mesh.vertices) {
      const auto pixel = Project(camera_, s.camera_from_world * p);
      ASSERT_TRUE(pixel && camera_.Contains(*pixel));
      top = std::min(top, along.dot(*pixel));
      bottom = std::max(bottom, along.dot(*pixel));
    }
    const double depth = (s.camera_from_world * V3(0, 0, 56)).z();
    EXPECT_NEAR(depth / camera_.fx, 0.24, 0.03);
    if (s.elevation_deg < 40) mean_height += bottom - top;
  }
  const auto low = std::count_if(stations_->begin(), stations_->end(),
                                 [](const CameraStation& s) { return s.elevation_deg < 40; });
  EXPECT_NEAR(mean_height / static_cast<double>(low) / 720, 0.70, 0.08);
}

TEST_F(CameraPathTest, CoversTheHemisphereEvenly) {
  // No direction in the range is far from a station: 120 even ones are about 14 degrees apart.
  const V3 center(0, 0, 56);
  for (double elevation = 15; elevation <= 80; elevation += 5) {
    for (double azimuth = 0; azimuth < 360; azimuth += 10) {
      const double e = elevation * kDegree, a = azimuth * kDegree;
      const V3 direction(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
      double best = -1;
      for (const CameraStation& s : *stations_) {
        best = std::max(best, direction.dot((s.camera_from_world.Center() - center).normalized()));
      }
      EXPECT_LT(std::acos(best) / kDegree, 17) << elevation << " " << azimuth;
    }
  }
}

TEST_F(CameraPathTest, TestStationsAreSpreadAndNotAtTheRim) {
  std::vector<V3> tests;
  for (const CameraStation& s : *stations_) {
    if (s.split != PhotoSplit::kTest) continue;
    EXPECT_GT(s.elevation_deg, 11);
    EXPECT_LT(s.elevation_deg, 80);
    tests.push_back((s.camera_from_world.Center() - V3(0, 0, 56)).normalized());
  }
  ASSERT_EQ(tests.size(), 16u);
  double nearest = 180;
  for (size_t i = 0; i < tests.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      nearest = std::min(nearest, std::acos(tests[i].dot(tests[j])) / kDegree);
    }
  }
  EXPECT_GT(nearest, 8);
}

TEST_F(CameraPathTest, MostPhotographsSeeSeveralTags) {
  const Board board = DefaultBoard();
  int good = 0;
  for (const CameraStation& s : *stations_) {
    int tags = 0;
    for (const BoardTag& tag : board.tags) {
      const auto corners = board.TagCorners(tag);
      tags += std::all_of(corners.begin(), corners.end(), [&](const V3& p) {
        const auto pixel = Project(camera_, s.camera_from_world * p);
        return pixel && camera_.Contains(*pixel);
      });
    }
    good += tags >= 6;
  }
  EXPECT_GE(good, 110);
}

TEST_F(CameraPathTest, IsDeterministicBySeed) {
  CameraPathOptions options;
  const auto again = MakeCameraPath(camera_, bust_->mesh, options);
  EXPECT_EQ(again[17].camera_from_world.translation,
            (*stations_)[17].camera_from_world.translation);
  options.seed = 2;
  const auto other = MakeCameraPath(camera_, bust_->mesh, options);
  EXPECT_NE(other[17].camera_from_world.translation,
            (*stations_)[17].camera_from_world.translation);
}

TEST_F(CameraPathTest, RejectsMoreTestThanPhotos) {
  CameraPathOptions options;
  options.photos = 3;
  options.test_photos = 4;
  EXPECT_THROW(MakeCameraPath(camera_, bust_->mesh, options), Error);
}

TEST(ScanRig, CameraAndProjectorAreFixedAndTwentyToTwentyFiveDegreesApart) {
  const ScanRig rig = MakeScanRig(640, 480, 1024, 768);
  const std::vector<Pose> poses = MakeScanPoses(18, 15, 48);
  ASSERT_EQ(poses.size(), 18u);
  const V3 target(0, 0, 54);
  int low = 0;
  for (const Pose& camera_from_world : poses) {
    const V3 camera = camera_from_world.Center();
    const V3 projector = (rig.projector_from_camera * camera_from_world).Center();
    const double angle =
        std::acos((camera - target).normalized().dot((projector - target).normalized())) / kDegree;
    EXPECT_GE(angle, 20);
    EXPECT_LE(angle, 25);
    low += camera.z() < 250;
    const auto pixel =
        Project(rig.projector, rig.projector_from_camera * camera_from_world * target);
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), 511.5, 60);
    EXPECT_NEAR(pixel->y(), 383.5, 60);
  }
  EXPECT_EQ(low, 9);
}

TEST(ScanRig, PlatformTurnsByTwentyDegrees) {
  const std::vector<Pose> poses = MakeScanPoses(18, 15, 48);
  for (size_t i = 0; i < poses.size(); ++i) {
    const V3 a = poses[i].Center(), b = poses[(i + 1) % poses.size()].Center();
    double turn = (std::atan2(b.y(), b.x()) - std::atan2(a.y(), a.x())) / kDegree;
    turn = std::remainder(turn, 360);
    EXPECT_NEAR(turn, 20, 1e-6);
  }
}

TEST(ScanRig, PlacementsTiltInDifferentDirectionsAndFaceTheRig) {
  const ScanRig rig = MakeScanRig(640, 480, 1024, 768);
  const std::vector<PlatformPlacement> placements = MakePlacements(5);
  std::vector<double> leans;
  for (const PlatformPlacement& p : placements) {
    const Pose table_from_world = p.world_from_table.Inverse();
    const V3 normal = table_from_world.rotation * V3::UnitZ();
    const double tilt = std::acos(normal.z()) / kDegree;
    EXPECT_GE(tilt, 15);
    EXPECT_LE(tilt, 40);
    EXPECT_NEAR(tilt, p.tilt_deg, 1e-6);
    leans.push_back(std::atan2(normal.y(), normal.x()) / kDegree);
    // No corner below the table, the middle raised above where it stands otherwise.
    EXPECT_GT(table_from_world.translation.z(), 10);
    for (double x : {-110.0, 110.0}) {
      for (double y : {-110.0, 110.0}) EXPECT_GT((table_from_world * V3(x, y, -5)).z(), 0);
    }
    EXPECT_GT(p.camera_from_world.Center().z(), 100);
    const Pose projector_from_world = rig.projector_from_camera * p.camera_from_world;
    EXPECT_GT(projector_from_world.Center().z(), 100);
    const auto pixel = Project(rig.camera, p.camera_from_world * V3(0, 0, 0));
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), 320, 100);
    EXPECT_NEAR(pixel->y(), 240, 100);
  }
  for (size_t i = 0; i < leans.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      EXPECT_GT(std::abs(std::remainder(leans[i] - leans[j], 360)), 30);
    }
  }
}

}  // namespace
}  // namespace lfm
