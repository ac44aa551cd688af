// SPDX-License-Identifier: BSD-3-Clause
#include "scan/consensus.h"

#include <gtest/gtest.h>

#include "tests/scan/synthetic_rig.h"

namespace lfm {
namespace {

using testing::HitPlate;
using testing::KnownRig;
using testing::TurnedPlatform;

/// The plate as a scan measures it without error.
PosedRange PlateScan(const Camera& camera, const std::vector<Eigen::Vector2d>& rays,
                     double degrees) {
  PosedRange scan;
  scan.camera_from_world = TurnedPlatform(degrees);
  scan.map.width = camera.width;
  scan.map.height = camera.height;
  const Pose world_from_camera = scan.camera_from_world.Inverse();
  for (const Eigen::Vector2d& ray : rays) {
    const Eigen::Vector3d direction = world_from_camera.rotation * ray.homogeneous();
    const auto hit = HitPlate(scan.camera_from_world.Center(), direction);
    scan.map.depth.push_back(hit ? hit->distance : 0);
    scan.map.normal.push_back(
        (scan.camera_from_world.rotation * Eigen::Vector3d::UnitZ()).cast<float>());
    scan.map.confidence.push_back(hit ? 0.9F : 0.0F);
    scan.map.sigma_mm.push_back(hit ? 0.02F : 0.0F);
  }
  return scan;
}

/// Lifts a square of pixels towards the camera.
void Lift(PosedRange& scan, int x0, int y0, int side, double mm) {
  for (int y = y0; y < y0 + side; ++y) {
    for (int x = x0; x < x0 + side; ++x) {
      scan.map.depth[static_cast<size_t>(y) * scan.map.width + x] -= mm;
    }
  }
}

int CountCleared(const PosedRange& scan, int x0, int y0, int side) {
  int cleared = 0;
  for (int y = y0; y < y0 + side; ++y) {
    for (int x = x0; x < x0 + side; ++x) {
      cleared += scan.map.depth[static_cast<size_t>(y) * scan.map.width + x] == 0 ? 1 : 0;
    }
  }
  return cleared;
}

TEST(Consensus, OthersSeeThroughAFloatingPatchAndOutvoteAWrongSurface) {
  const Camera camera = KnownRig(true).camera;
  const std::vector<Eigen::Vector2d> rays = NormalizedRays(camera);
  std::vector<PosedRange> scans;
  for (double degrees : {0.0, 45.0, 90.0}) scans.push_back(PlateScan(camera, rays, degrees));
  Lift(scans[0], 100, 80, 12, 20);  // floats 20 mm in front
  Lift(scans[1], 120, 90, 8, 1.2);  // a dent of a millimetre that nobody else sees
  const auto kept = KeepConsensus(scans, camera, rays, {});
  EXPECT_GE(CountCleared(kept[0], 100, 80, 12), 130);
  EXPECT_GE(CountCleared(kept[1], 120, 90, 8), 60);
  EXPECT_EQ(CountCleared(kept[2], 100, 80, 12), 0);
  EXPECT_EQ(CountCleared(kept[0], 140, 80, 12), 0);
}

TEST(Consensus, SinglePixelsOfAnotherScanDoNotOutvoteWhatThoseBesideThemShow) {
  const Camera camera = KnownRig(true).camera;
  const std::vector<Eigen::Vector2d> rays = NormalizedRays(camera);
  std::vector<PosedRange> scans = {PlateScan(camera, rays, 0), PlateScan(camera, rays, 45)};
  for (int y = 60; y < 120; y += 2) {
    for (int x = 80; x < 140; x += 2) Lift(scans[1], x, y, 1, 1.2);
  }
  // The first scan is hardly sure of anything: a voice against it would clear it.
  scans[0].map.confidence.assign(rays.size(), 0.05F);
  const auto kept = KeepConsensus(scans, camera, rays, {});
  EXPECT_EQ(CountCleared(kept[0], 70, 50, 80), 0);
}

TEST(Consensus, WhatOnlyOneScanSawStaysAndSpecksGo) {
  const Camera camera = KnownRig(false).camera;
  const std::vector<Eigen::Vector2d> rays = NormalizedRays(camera);
  PosedRange lone = PlateScan(camera, rays, 0);
  for (size_t p = 0; p < rays.size(); ++p) {
    const int x = static_cast<int>(p) % camera.width, y = static_cast<int>(p) / camera.width;
    const bool patch = x >= 50 && x < 60 && y >= 50 && y < 60;
    const bool speck = x >= 100 && x < 104 && y >= 50 && y < 54;
    if (!patch && !speck) lone.map.depth[p] = 0;
  }
  const auto kept = KeepConsensus({lone}, camera, rays, {});
  EXPECT_EQ(CountCleared(kept[0], 50, 50, 10), 0);
  EXPECT_EQ(CountCleared(kept[0], 100, 50, 4), 16);
  EXPECT_TRUE(KeepConsensus({}, camera, rays, {}).empty());
}

/// Two scans, of which the second shows nothing at all.
std::vector<PosedRange> OneThatSees(const Camera& camera, const std::vector<Eigen::Vector2d>& rays,
                                    float sigma_mm) {
  std::vector<PosedRange> scans = {PlateScan(camera, rays, 0), PlateScan(camera, rays, 45)};
  scans[1].map.depth.assign(rays.size(), 0.0);
  scans[0].map.sigma_mm.assign(rays.size(), sigma_mm);
  return scans;
}

TEST(Consensus, InexactPointsNeedAnotherScanUnlessTheyAreOblique) {
  const Camera camera = KnownRig(true).camera;
  const std::vector<Eigen::Vector2d> rays = NormalizedRays(camera);
  std::vector<PosedRange> scans = OneThatSees(camera, rays, 0.2F);
  EXPECT_EQ(CountCleared(KeepConsensus(scans, camera, rays, {})[0], 100, 80, 12), 144);
  // The edge of what all scans see together.
  const Pose& pose = scans[0].camera_from_world;
  for (size_t p = 0; p < rays.size(); ++p) {
    const Eigen::Vector3d sight = -rays[p].homogeneous().normalized();
    const Eigen::Vector3d across = sight.cross(pose.rotation.col(0)).normalized();
    scans[0].map.normal[p] = (across + 0.15 * sight).normalized().cast<float>();
  }
  EXPECT_EQ(CountCleared(KeepConsensus(scans, camera, rays, {})[0], 100, 80, 12), 0);
  scans = OneThatSees(camera, rays, 0.05F);
  EXPECT_EQ(CountCleared(KeepConsensus(scans, camera, rays, {})[0], 100, 80, 12), 0);
  scans = OneThatSees(camera, rays, 0.2F);
  scans.pop_back();
  EXPECT_EQ(CountCleared(KeepConsensus(scans, camera, rays, {})[0], 100, 80, 12), 0);
  // One that agrees is enough.
  scans = {PlateScan(camera, rays, 0), PlateScan(camera, rays, 45), PlateScan(camera, rays, 90)};
  scans[0].map.sigma_mm.assign(rays.size(), 0.2F);
  scans[1].map.depth.assign(rays.size(), 0.0);
  EXPECT_EQ(CountCleared(KeepConsensus(scans, camera, rays, {})[0], 100, 80, 12), 0);
}

// A scene ten times as large, measured ten times as coarsely, is judged alike.
TEST(Consensus, IsTheSameForLargeObjects) {
  const Camera camera = KnownRig(true).camera;
  const std::vector<Eigen::Vector2d> rays = NormalizedRays(camera);
  const auto cleared = [&](double scale) {
    std::vector<PosedRange> scans;
    for (double degrees : {0.0, 45.0, 90.0}) scans.push_back(PlateScan(camera, rays, degrees));
    Lift(scans[0], 100, 80, 12, 20);
    Lift(scans[1], 120, 90, 8, 1.2);
    for (PosedRange& scan : scans) {
      scan.camera_from_world.translation *= scale;
      for (double& depth : scan.map.depth) depth *= scale;
      for (float& sigma : scan.map.sigma_mm) sigma *= static_cast<float>(scale);
    }
    std::vector<int> counts;
    for (const PosedRange& scan : KeepConsensus(scans, camera, rays, {})) {
      counts.push_back(CountCleared(scan, 0, 0, std::min(camera.width, camera.height)));
    }
    return counts;
  };
  EXPECT_EQ(cleared(10), cleared(1));
  EXPECT_EQ(cleared(0.1), cleared(1));
}

// Noise that two scans know of is no contradiction.
TEST(Consensus, NoiseOfTwoScansDoesNotOutvoteThem) {
  const Camera camera = KnownRig(true).camera;
  const std::vector<Eigen::Vector2d> rays = NormalizedRays(camera);
  const auto cleared = [&](float sigma_mm) {
    std::vector<PosedRange> scans;
    for (double degrees : {0.0, 45.0, 90.0, 135.0}) {
      scans.push_back(PlateScan(camera, rays, degrees));
      scans.back().map.sigma_mm.assign(rays.size(), sigma_mm);
    }
    scans[0].map.confidence.assign(rays.size(), 0.5F);
    for (double& depth : scans[1].map.depth) depth -= 1;
    for (double& depth : scans[2].map.depth) depth -= 1;
    return CountCleared(KeepConsensus(scans, camera, rays, {})[0], 100, 80, 12);
  };
  EXPECT_EQ(cleared(0.02F), 144);
  EXPECT_EQ(cleared(0.4F), 0);
}

TEST(Consensus, OneKnobScalesEveryLimit) {
  const ConsensusOptions usual, twice = ConsensusWithin(2 * usual.agree);
  EXPECT_DOUBLE_EQ(twice.agree, 2 * usual.agree);
  EXPECT_DOUBLE_EQ(twice.contradict, 2 * usual.contradict);
  EXPECT_DOUBLE_EQ(twice.clear, 2 * usual.clear);
  EXPECT_DOUBLE_EQ(twice.exact, 2 * usual.exact);
}

}  // namespace
}  // namespace lfm
