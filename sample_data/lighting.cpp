// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/lighting.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "sample_data/lanes/lane_lights.h"

namespace lfm {

Eigen::Vector3f Lighting::Environment(const Eigen::Vector3f& direction) const {
  LightTables room;
  for (int c = 0; c < 3; ++c) {
    room.sky[c] = sky[c];
    room.wall[c] = wall[c];
    room.ground[c] = ground[c];
  }
  const Vec<float> radiance =
      RoomRadiance(room, Vec<float>{direction.x(), direction.y(), direction.z()});
  return {radiance.x, radiance.y, radiance.z};
}

AreaLight AimLight(const Eigen::Vector3d& target, double azimuth_deg, double elevation_deg,
                   double distance_mm, double width_mm, double height_mm,
                   const Eigen::Vector3f& radiance) {
  const double azimuth = azimuth_deg * std::numbers::pi / 180;
  const double elevation = elevation_deg * std::numbers::pi / 180;
  const Eigen::Vector3d outward(std::cos(elevation) * std::cos(azimuth),
                                std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
  const Eigen::Vector3d right(-std::sin(azimuth), std::cos(azimuth), 0);
  AreaLight light;
  light.center = target + distance_mm * outward;
  light.half_u = 0.5 * width_mm * right;
  // half_u x half_v points back at the target.
  light.half_v = 0.5 * height_mm * right.cross(outward);
  light.radiance = radiance;
  return light;
}

Lighting MakeStudioLighting() {
  const Eigen::Vector3d target(0, 0, 60);
  Lighting lighting;
  lighting.lights = {
      AimLight(target, -128, 46, 620, 250, 240, {6.9f, 6.35f, 5.6f}),
      AimLight(target, -24, 38, 680, 220, 320, {3.2f, 3.5f, 3.95f}),
      AimLight(target, 88, 52, 600, 320, 180, {3.8f, 3.8f, 3.8f}),
  };
  lighting.sky = {0.10f, 0.105f, 0.12f};
  lighting.wall = {0.060f, 0.056f, 0.052f};
  lighting.ground = {0.02f, 0.02f, 0.02f};
  return lighting;
}

}  // namespace lfm
