// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/truth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "core/error.h"

namespace lfm {
namespace {

// A latitude-longitude sphere of radius r around (0, 0, 60).
TriangleMesh Sphere(double radius) {
  constexpr int kRows = 48, kColumns = 96;
  TriangleMesh mesh;
  for (int i = 0; i <= kRows; ++i) {
    for (int j = 0; j < kColumns; ++j) {
      const double theta = std::numbers::pi * i / kRows, phi = 2 * std::numbers::pi * j / kColumns;
      mesh.vertices.emplace_back(radius * std::sin(theta) * std::cos(phi),
                                 radius * std::sin(theta) * std::sin(phi),
                                 60 + radius * std::cos(theta));
    }
  }
  for (int i = 0; i < kRows; ++i) {
    for (int j = 0; j < kColumns; ++j) {
      const int a = i * kColumns + j, b = i * kColumns + (j + 1) % kColumns;
      if (i > 0) mesh.triangles.emplace_back(a, a + kColumns, b);
      if (i + 1 < kRows) mesh.triangles.emplace_back(b, a + kColumns, b + kColumns);
    }
  }
  return mesh;
}

GroundTruth SphereTruth() {
  GroundTruth truth;
  truth.mesh = Sphere(40);
  truth.plate_half_mm = {110, 110};
  Photo photo;
  photo.id = "p";
  photo.camera_from_world = LookAt({300, 0, 200}, {0, 0, 60}, {0, 0, 1});
  truth.capture.photos = {photo};
  return truth;
}

TEST(MeasurePoses, MeasuresCentresAndAngles) {
  const GroundTruth truth = SphereTruth();
  CalibResult calib;
  PosedImage photo;
  photo.id = "p";
  const Pose moved{Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitY()).toRotationMatrix(),
                   Eigen::Vector3d::Zero()};
  photo.camera_from_world = moved * *truth.capture.photos[0].camera_from_world;
  calib.photos = {photo};
  const PoseErrors turned = MeasurePoses(calib, truth);
  EXPECT_NEAR(turned.median_deg, 0.01 * 180 / std::numbers::pi, 1e-9);
  EXPECT_NEAR(turned.median_mm, 0, 1e-9);  // turning a camera about itself moves nothing
  calib.photos[0].camera_from_world = *truth.capture.photos[0].camera_from_world;
  calib.photos[0].camera_from_world.translation += Eigen::Vector3d(0.3, 0, 0.4);
  EXPECT_NEAR(MeasurePoses(calib, truth).median_mm, 0.5, 1e-9);
}

TEST(MeasurePoses, RefusesPhotographsThatTheTruthDoesNotKnow) {
  CalibResult calib;
  calib.photos.resize(1);
  calib.photos[0].id = "unknown";
  EXPECT_THROW(MeasurePoses(calib, SphereTruth()), Error);
}

// Photographs all round, each at its true pose moved by `change`.
CalibResult Calibrated(GroundTruth& truth, const std::function<Pose(const Pose&)>& change) {
  CalibResult calib;
  truth.capture.photos.clear();
  for (int i = 0; i < 8; ++i) {
    Photo photo;
    photo.id = "p" + std::to_string(i);
    photo.camera = "photo";
    photo.camera_from_world = LookAt(
        {300 * std::cos(0.7 * i), 300 * std::sin(0.7 * i), 150 + 20.0 * i}, {0, 0, 60}, {0, 0, 1});
    truth.capture.photos.push_back(photo);
    PosedImage posed;
    posed.id = photo.id, posed.camera = "found";
    posed.camera_from_world = change(*photo.camera_from_world);
    calib.photos.push_back(posed);
  }
  return calib;
}

TEST(MeasureAlignedPoses, TakesAwayASimilarityAndNamesItsScale) {
  GroundTruth truth = SphereTruth();
  const CalibResult calib = Calibrated(truth, [](const Pose& pose) {
    Pose larger = pose;
    larger.translation *= 1.01;
    return larger;
  });
  EXPECT_GT(MeasurePoses(calib, truth).median_mm, 2);
  const AlignedPoseErrors errors = MeasureAlignedPoses(calib, truth);
  EXPECT_NEAR(errors.median_mm, 0, 1e-9);
  EXPECT_NEAR(errors.scale_percent, 1, 1e-9);
}

TEST(MeasurePoseHonesty, IsTheNormalisedSquaredError) {
  GroundTruth truth = SphereTruth();
  CalibResult calib = Calibrated(truth, [](const Pose& pose) {
    Pose moved = pose;
    moved.translation.x() += 0.3;
    return moved;
  });
  EXPECT_EQ(MeasurePoseHonesty(calib, truth), 0);  // no covariance at all
  for (PosedImage& photo : calib.photos) {
    photo.covariance.setIdentity();
    photo.covariance *= 0.01;
  }
  EXPECT_NEAR(MeasurePoseHonesty(calib, truth), 9.0 / 6, 1e-6);
}

TEST(MeasurePhotoIntrinsics, ComparesTheCamerasOfTheSamePictures) {
  GroundTruth truth = SphereTruth();
  CalibResult calib = Calibrated(truth, [](const Pose& pose) { return pose; });
  EXPECT_EQ(MeasurePhotoIntrinsics(calib, truth).cameras, 0);
  truth.capture.cameras["photo"].intrinsics = Camera{640, 480, 1000, 1000, 320, 240};
  calib.cameras["found"] = Camera{640, 480, 1001, 998, 320.3, 239.6};
  const IntrinsicsErrors errors = MeasurePhotoIntrinsics(calib, truth);
  EXPECT_EQ(errors.cameras, 1);
  EXPECT_NEAR(errors.focal_percent, 0.2, 1e-9);
  EXPECT_NEAR(errors.principal_point_px, 0.5, 1e-9);
  EXPECT_EQ(MeasureScannerIntrinsics(calib, truth).cameras, 0);
}

TEST(GeometryJudge, MeasuresAConcentricSphere) {
  const GeometryJudge judge(SphereTruth());
  const SurfaceErrors errors = judge.MeasureSurface(Sphere(40.25));
  constexpr double kFacets_abs = 0.03;
  EXPECT_NEAR(errors.mean_mm, 0.25, kFacets_abs);
  EXPECT_NEAR(errors.p95_mm, 0.25, 2 * kFacets_abs);
  EXPECT_NEAR(errors.rms_mm, 0.25, kFacets_abs);
  EXPECT_GE(errors.max_mm, errors.p95_mm);
  EXPECT_LT(errors.f_score, 0.2);  // it lies beyond the threshold of 0.2 mm
  const SurfaceErrors none = judge.MeasureSurface(Sphere(40));
  EXPECT_NEAR(none.mean_mm, 0, kFacets_abs);
  EXPECT_EQ(none.accuracy, 1);
  EXPECT_EQ(none.completeness, 1);
  EXPECT_EQ(none.f_score, 1);
}

TEST(GeometryJudge, CountsTheMissingHalfAsIncomplete) {
  const GeometryJudge judge(SphereTruth());
  PointCloud upper;
  for (const Eigen::Vector3d& p : Sphere(40.05).vertices) {
    if (p.z() > 60) upper.points.push_back(p);
  }
  const PointErrors errors = judge.MeasurePoints(upper);
  EXPECT_NEAR(errors.median_mm, 0.05, 0.03);
  EXPECT_LT(errors.completeness, 0.5);
  EXPECT_GT(errors.completeness, 0.02);
  EXPECT_EQ(errors.over_1_mm_share, 0);
}

TEST(GeometryJudge, PlatformPointsAreTrueToo) {
  const GeometryJudge judge(SphereTruth());
  PointCloud plate;
  plate.points = {{90, 90, 0.02}, {-90, 90, -0.02}, {90, -90, 0.02}};
  EXPECT_NEAR(judge.MeasurePoints(plate).median_mm, 0.02, 1e-9);
  PointCloud beside;
  beside.points = {{150, 0, 0}};
  EXPECT_GT(judge.MeasurePoints(beside).median_mm, 100);
}

TEST(GeometryJudge, SeesOnlyWhatCameraAndProjectorBothSee) {
  GroundTruth truth = SphereTruth();
  Camera eye{640, 480, 800, 800, 319.5, 239.5};
  Scanner scanner;
  scanner.camera = "scanner";
  scanner.projector = eye;
  scanner.projector_from_camera = Pose{};  // projector and camera in one place
  ScanSet scan;
  scan.camera_from_world = LookAt({300, 0, 60}, {0, 0, 60}, {0, 0, 1});
  scanner.scans = {scan};
  truth.capture.scanner = scanner;
  truth.capture.cameras["scanner"] = {640, 480, eye};
  const GeometryJudge judge(truth);
  PointCloud everything;
  everything.points = truth.mesh.vertices;
  const PointErrors errors = judge.MeasurePoints(everything);
  // A viewer at distance d sees the cap (1 - r / d) / 2 of a sphere.
  constexpr double kSampling_abs = 0.01;
  EXPECT_NEAR(errors.seen_share, (1 - 40.0 / 300) / 2, kSampling_abs);
}

}  // namespace
}  // namespace lfm
