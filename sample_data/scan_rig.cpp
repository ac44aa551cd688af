// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/scan_rig.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "sample_data/random.h"
#include "sample_data/studio_scene.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kDistanceMm = 430, kTargetHeightMm = 54;
constexpr double kPlacementElevationDeg = 48;
// In azimuth; with the rig's elevation it makes 22 degrees between the two lines of sight.
constexpr double kSeparationDeg = 25.6;

V3 Outward(double azimuth_deg, double elevation_deg) {
  const double a = azimuth_deg * kDegree, e = elevation_deg * kDegree;
  return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
}

// The rig's camera, `azimuth_deg` round the target; slightly rolled, as tripods are.
Pose StandCamera(double azimuth_deg, double elevation_deg, const V3& target) {
  const Pose roll{Eigen::AngleAxisd(1.7 * kDegree, V3::UnitZ()).toRotationMatrix(), V3::Zero()};
  return roll *
         LookAt(target + kDistanceMm * Outward(azimuth_deg, elevation_deg), target, V3::UnitZ());
}

}  // namespace

ScanRig MakeScanRig(int camera_width, int camera_height, int projector_width,
                    int projector_height) {
  ScanRig rig;
  Camera& c = rig.camera;
  c.width = camera_width;
  c.height = camera_height;
  const double cs = camera_width / 640.0;
  c.fx = 1193.0 * cs;
  c.fy = 1191.8 * cs;
  c.cx = (camera_width - 1) / 2.0 - 4.1 * cs;
  c.cy = (camera_height - 1) / 2.0 + 3.4 * cs;
  c.k1 = -0.095;
  c.k2 = 0.12;
  c.p1 = -0.0004;
  c.p2 = 0.0007;
  Camera& p = rig.projector;
  p.width = projector_width;
  p.height = projector_height;
  const double ps = projector_width / 1024.0;
  p.fx = 1752.0 * ps;
  p.fy = 1755.0 * ps;
  p.cx = (projector_width - 1) / 2.0 + 6.0 * ps;
  p.cy = (projector_height - 1) / 2.0 + 11.0 * ps;
  p.k1 = -0.03;
  p.k2 = 0.02;
  const V3 target(0, 0, kTargetHeightMm);
  const double half = kSeparationDeg / 2;
  const Pose camera_from_world = StandCamera(-90 - half, 30, target);
  const Pose projector_from_world =
      LookAt(target + (kDistanceMm + 12) * Outward(-90 + half, 33), target, V3::UnitZ());
  rig.projector_from_camera = projector_from_world * camera_from_world.Inverse();
  return rig;
}

std::vector<Pose> MakeScanPoses(int count, double low_deg, double high_deg) {
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    const double elevation = i % 2 == 0 ? high_deg : low_deg;
    poses.push_back(StandCamera(-90 - kSeparationDeg / 2 + 360.0 * i / count, elevation,
                                V3(0, 0, kTargetHeightMm)));
  }
  return poses;
}

Pose Wobble(double wobble_mm, RandomStream& random) {
  constexpr double kRimMm = 100;
  Pose wobbled;
  for (int c = 0; c < 3; ++c) wobbled.translation[c] = wobble_mm * random.Normal();
  const double tilt_x = wobble_mm / kRimMm * random.Normal();
  const double tilt_y = wobble_mm / kRimMm * random.Normal();
  wobbled.rotation =
      (Eigen::AngleAxisd(tilt_x, V3::UnitX()) * Eigen::AngleAxisd(tilt_y, V3::UnitY()))
          .toRotationMatrix();
  return wobbled;
}

std::vector<Pose> TroubleScanPoses(const std::vector<Pose>& poses, double axis_tilt_deg,
                                   double wobble_mm, uint64_t seed) {
  if (axis_tilt_deg == 0 && wobble_mm == 0) return poses;
  constexpr uint64_t kAxisStream = 51, kWobbleStream = 52;
  const double lean = 2 * std::numbers::pi * RandomStream(seed, kAxisStream, 0).Uniform();
  const V3 axis =
      Eigen::AngleAxisd(axis_tilt_deg * kDegree, V3(std::cos(lean), std::sin(lean), 0)) *
      V3::UnitZ();
  std::vector<Pose> troubled;
  for (size_t i = 0; i < poses.size(); ++i) {
    const double turn =
        2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(poses.size());
    // The camera went round a resting platform; the platform turns the other way.
    const Pose undone{Eigen::AngleAxisd(turn, V3::UnitZ()).toRotationMatrix(), V3::Zero()};
    const Pose turned{Eigen::AngleAxisd(-turn, axis).toRotationMatrix(), V3::Zero()};
    RandomStream random(seed, kWobbleStream, i);
    troubled.push_back(poses[i] * undone * Wobble(wobble_mm, random) * turned);
  }
  return troubled;
}

std::vector<PlatformPlacement> MakePlacements(int count) {
  // The plate leans towards these directions, counted from the rig's own azimuth; it leans less
  // where it would turn its face away from the rig.
  constexpr double kLeanDeg[] = {8, 95, -80, 160, -35};
  constexpr double kTiltDeg[] = {38, 31, 34, 16, 24};
  constexpr double kSpinDeg[] = {0, 35, -50, 80, 140};
  constexpr double kLiftMm[] = {4, 22, 12, 40, 2};
  constexpr double kShiftMm[][2] = {{-12, 8}, {14, -10}, {-6, -14}, {8, 12}, {0, 0}};
  std::vector<PlatformPlacement> placements;
  const Pose camera_from_room =
      StandCamera(-90 - kSeparationDeg / 2, kPlacementElevationDeg, V3(0, 0, kTargetHeightMm + 30));
  for (int i = 0; i < count; ++i) {
    const int k = i % 5;
    const double tilt = std::min(40.0, kTiltDeg[k] + i / 5) * kDegree;
    const double lean = (-90 + kLeanDeg[k] + 25.0 * (i / 5)) * kDegree;
    // Turning about the horizontal axis across the lean brings the normal over to that side.
    const V3 axis(-std::sin(lean), std::cos(lean), 0);
    const double reach = 150 * std::sin(tilt);
    Pose room_from_plate;
    room_from_plate.rotation = Eigen::AngleAxisd(tilt, axis).toRotationMatrix() *
                               Eigen::AngleAxisd(kSpinDeg[k] * kDegree, V3::UnitZ());
    room_from_plate.translation = {kShiftMm[k][0], kShiftMm[k][1], reach * 0.75 + kLiftMm[k] + 15};
    const Pose room_from_table{Eigen::Matrix3d::Identity(), V3(0, 0, -kPlateThicknessMm - 40)};
    PlatformPlacement placement;
    placement.tilt_deg = tilt / kDegree;
    placement.camera_from_world = camera_from_room * room_from_plate;
    placement.world_from_table = room_from_plate.Inverse() * room_from_table;
    placements.push_back(placement);
  }
  return placements;
}

}  // namespace lfm
