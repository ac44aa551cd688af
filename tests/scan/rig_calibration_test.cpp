// SPDX-License-Identifier: BSD-3-Clause
#include "scan/rig_calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "core/error.h"
#include "scan/projector_resection.h"
#include "scan/triangulate.h"
#include "tests/scan/synthetic_rig.h"

namespace lfm {
namespace {

using testing::KnownRig;
using testing::TiltedPlacements;
using testing::TiltedPlatform;
using testing::TurnedPlatform;

struct Noise {
  double projector_px = 0;
  double pose_rad = 0, pose_mm = 0;
  double outliers = 0;  ///< share
  Eigen::Vector3d bend_per_mm = Eigen::Vector3d::Zero();
};

struct Scene {
  RigCalibration truth;
  std::vector<PlatePlacement> placements;
  std::vector<PlateCorrespondence> correspondences;
};

/// A grid of plate points under each pose, projected into camera and projector.
Scene MakeScene(const RigCalibration& truth, const std::vector<Pose>& poses, const Noise& noise) {
  Scene scene;
  scene.truth = truth;
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0, 1);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (size_t i = 0; i < poses.size(); ++i) {
    PlatePlacement placement;
    Eigen::Vector3d turn(normal(random), normal(random), normal(random));
    turn *= noise.pose_rad;
    const Pose error{
        Eigen::AngleAxisd(turn.norm() + 1e-300, (turn + Eigen::Vector3d(0, 0, 1e-300)).normalized())
            .toRotationMatrix(),
        noise.pose_mm * Eigen::Vector3d(normal(random), normal(random), normal(random))};
    placement.camera_from_world.rotation = error.rotation * poses[i].rotation;
    placement.camera_from_world.translation = poses[i].translation + error.translation;
    placement.covariance.diagonal() << Eigen::Vector3d::Constant(noise.pose_rad * noise.pose_rad),
        Eigen::Vector3d::Constant(noise.pose_mm * noise.pose_mm);
    scene.placements.push_back(placement);
    for (double y = -100; y <= 100; y += 8) {
      for (double x = -100; x <= 100; x += 8) {
        const Eigen::Vector3d& bend = noise.bend_per_mm;
        const double z = bend.x() * x * x + bend.y() * x * y + bend.z() * y * y;
        const Eigen::Vector3d point = poses[i] * Eigen::Vector3d(x, y, z);
        const auto seen = Project(truth.camera, point);
        const auto lit = Project(truth.projector, truth.projector_from_camera * point);
        if (!seen || !lit || !truth.camera.Contains(*seen) || !truth.projector.Contains(*lit)) {
          continue;
        }
        PlateCorrespondence c;
        c.placement = static_cast<int>(i);
        c.ray = Unproject(truth.camera, *seen).hnormalized();
        c.plate = PlateUnderRay(placement.camera_from_world, c.ray, bend);
        c.projector_px =
            *lit + noise.projector_px * Eigen::Vector2d(normal(random), normal(random));
        c.sigma_px.setConstant(std::max(noise.projector_px, 1e-3));
        if (uniform(random) < noise.outliers) c.projector_px.x() += 16;
        scene.correspondences.push_back(c);
      }
    }
  }
  return scene;
}

RigAdjustment Calibrate(const Scene& scene) {
  return CalibrateRig(scene.truth.camera, scene.truth.projector.width, scene.truth.projector.height,
                      scene.placements, scene.correspondences, {});
}

/// Largest error of triangulated depths over the working volume, mm.
double WorstDepthError(const RigCalibration& rig, const RigCalibration& truth) {
  double worst = 0;
  for (double z = 0; z <= 120; z += 40) {
    for (double y = -60; y <= 60; y += 30) {
      for (double x = -60; x <= 60; x += 30) {
        const Eigen::Vector3d point = TurnedPlatform(0) * Eigen::Vector3d(x, y, z);
        const auto column = Project(truth.projector, truth.projector_from_camera * point);
        if (!column || !truth.projector.Contains(*column)) continue;
        const auto depth = DepthFromColumn(rig, point.hnormalized(), column->x());
        worst = std::max(worst, depth ? std::abs(*depth - point.z()) : 1e3);
      }
    }
  }
  return worst;
}

void ExpectMotionError(const std::function<void()>& run) {
  try {
    run();
    FAIL() << "calibrated a rig that cannot be calibrated";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("cannot be calibrated"), std::string::npos)
        << error.what();
    EXPECT_NE(std::string(error.what()).find("tilted"), std::string::npos) << error.what();
  }
}

TEST(RigCalibration, ExactCorrespondencesGiveTheRigBack) {
  for (bool distorted : {false, true}) {
    const Scene scene = MakeScene(KnownRig(distorted), TiltedPlacements(), {});
    const RigAdjustment found = Calibrate(scene);
    const Camera& truth = scene.truth.projector;
    EXPECT_NEAR(found.rig.projector.fx, truth.fx, 1e-6 * truth.fx);
    EXPECT_NEAR(found.rig.projector.fy, truth.fy, 1e-6 * truth.fy);
    EXPECT_NEAR(found.rig.projector.cx, truth.cx, 1e-3);
    EXPECT_NEAR(found.rig.projector.cy, truth.cy, 1e-3);
    EXPECT_NEAR(found.rig.projector.k1, truth.k1, 1e-4);
    EXPECT_LT((found.rig.projector_from_camera.translation -
               scene.truth.projector_from_camera.translation)
                  .norm(),
              1e-3);
    EXPECT_LT(RotationAngle(found.rig.projector_from_camera.rotation,
                            scene.truth.projector_from_camera.rotation),
              1e-6);
    EXPECT_LT(found.rig.projector_rms_px, 1e-5);
    EXPECT_LT(WorstDepthError(found.rig, scene.truth), 1e-4);
    EXPECT_EQ(found.rig.projector_terms > 0, distorted);
    EXPECT_EQ(found.used, static_cast<int>(scene.correspondences.size()));
  }
}

TEST(RigCalibration, ABentPlateIsCountedOnWhereItIsKnown) {
  Noise noise;
  noise.bend_per_mm = {-3e-5, 1e-5, 2e-5};  // 0.3 mm at the rim
  Scene scene = MakeScene(KnownRig(true), TiltedPlacements(), noise);
  EXPECT_LT(WorstDepthError(Calibrate(scene).rig, scene.truth), 1e-4);
  for (PlateCorrespondence& c : scene.correspondences) c.plate = {};
  EXPECT_GT(WorstDepthError(Calibrate(scene).rig, scene.truth), 0.05);
}

TEST(RigCalibration, NoiseOfATwentiethPixelStaysWithinStatedBounds) {
  Noise noise;
  noise.projector_px = 0.05;
  noise.pose_rad = 5e-5;
  noise.pose_mm = 0.02;
  const Scene scene = MakeScene(KnownRig(true), TiltedPlacements(), noise);
  const RigAdjustment found = Calibrate(scene);
  EXPECT_NEAR(found.rig.projector_rms_px, 0.05 * std::sqrt(2.0), 0.01);
  EXPECT_LT(WorstDepthError(found.rig, scene.truth), 0.12);
  EXPECT_NEAR(found.rig.projector.fx, scene.truth.projector.fx, 1.0);
  EXPECT_LT(found.rig.condition, 1e6);
}

TEST(RigCalibration, ATwentiethOfWrongPeriodsDoesNotMoveIt) {
  Noise noise;
  noise.projector_px = 0.05;
  const Scene clean = MakeScene(KnownRig(false), TiltedPlacements(), noise);
  noise.outliers = 0.05;
  const Scene dirty = MakeScene(KnownRig(false), TiltedPlacements(), noise);
  EXPECT_LT(WorstDepthError(Calibrate(clean).rig, clean.truth), 0.06);
  const RigAdjustment found = Calibrate(dirty);
  EXPECT_LT(WorstDepthError(found.rig, dirty.truth), 0.09);
  EXPECT_LT(found.used, static_cast<int>(0.97 * static_cast<double>(dirty.correspondences.size())));
}

TEST(RigCalibration, APlatformThatOnlyTurnsIsRefused) {
  std::vector<Pose> turned;
  for (double degrees : {0.0, 40.0, 80.0, 120.0, 160.0}) turned.push_back(TurnedPlatform(degrees));
  for (const Noise& noise : {Noise{}, Noise{0.05, 1e-4, 0.05, 0}, Noise{0.1, 5e-4, 0.2, 0.02}}) {
    const Scene scene = MakeScene(KnownRig(false), turned, noise);
    ExpectMotionError([&] { Calibrate(scene); });
  }
}

TEST(RigCalibration, PlacementsThatBarelyDifferAreRefusedByTheirCondition) {
  const std::vector<Pose> poses = {TiltedPlatform(0, 0, 0), TiltedPlatform(1.2, 0, 1),
                                   TiltedPlatform(-1.2, 90, 1)};
  const Scene scene = MakeScene(KnownRig(false), poses, Noise{0.02, 1e-5, 0.005, 0});
  ExpectMotionError([&] { Calibrate(scene); });
  try {
    Calibrate(scene);
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("condition number"), std::string::npos)
        << error.what();
  }
}

TEST(RigCalibration, OnePlacementIsRefused) {
  const Scene one = MakeScene(KnownRig(false), {TiltedPlatform(25, 0, 20)}, {});
  ExpectMotionError([&] { Calibrate(one); });
  Scene twice =
      MakeScene(KnownRig(false), {TiltedPlatform(25, 0, 20), TiltedPlatform(0, 0, 0)}, {});
  Calibrate(twice);
  // The second placement's pictures failed but for a few pixels.
  std::erase_if(twice.correspondences, [count = 0](const PlateCorrespondence& c) mutable {
    return c.placement == 1 && ++count > 20;
  });
  ExpectMotionError([&] { Calibrate(twice); });
  ExpectMotionError([&] { CalibrateRig(one.truth.camera, 512, 384, {}, {}, {}); });
}

TEST(RigCalibration, ColumnsAloneAreRefused) {
  Scene scene = MakeScene(KnownRig(false), TiltedPlacements(), {});
  for (PlateCorrespondence& c : scene.correspondences) c.sigma_px.y() = 0;
  ExpectMotionError([&] { Calibrate(scene); });
}

TEST(RigCalibration, TwoRunsAgreeToTheLastBit) {
  Noise noise;
  noise.projector_px = 0.05;
  const Scene scene = MakeScene(KnownRig(true), TiltedPlacements(), noise);
  const RigAdjustment a = Calibrate(scene), b = Calibrate(scene);
  EXPECT_EQ(a.rig.projector.fx, b.rig.projector.fx);
  EXPECT_EQ(a.rig.projector_from_camera.translation, b.rig.projector_from_camera.translation);
}

TEST(ProjectorResection, RefusesTooFewMirroredAndNonFinitePoints) {
  const Scene scene = MakeScene(KnownRig(false), TiltedPlacements(), {});
  std::vector<ResectionPoint> points;
  for (const PlateCorrespondence& c : scene.correspondences) {
    const Pose& pose = scene.placements[static_cast<size_t>(c.placement)].camera_from_world;
    const Eigen::Vector3d normal = pose.rotation.col(2);
    const Eigen::Vector3d ray = c.ray.homogeneous();
    points.push_back({ray * (normal.dot(pose.translation) / normal.dot(ray)), c.projector_px});
  }
  const Resection found = ResectProjector(points, 512, 384);
  EXPECT_NEAR(found.projector.fx, scene.truth.projector.fx, 1e-3);
  std::vector<ResectionPoint> mirrored = points;
  for (ResectionPoint& p : mirrored) p.projector_px.x() = 511 - p.projector_px.x();
  EXPECT_THROW(ResectProjector(mirrored, 512, 384), Error);
  std::vector<ResectionPoint> broken = points;
  broken[3].projector_px.x() = std::nan("");
  EXPECT_THROW(ResectProjector(broken, 512, 384), Error);
  points.resize(11);
  EXPECT_THROW(ResectProjector(points, 512, 384), Error);
  EXPECT_EQ(CloudThickness({}), 0);
}

}  // namespace
}  // namespace lfm
