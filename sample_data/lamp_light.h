// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "sample_data/lighting.h"

namespace lfm {

/// An AreaLight in float32, ready for the path tracer. A lamp shines from its front; it has no back
/// and stands in nobody's way: rays see its light, and go on. Points are drawn uniformly over its
/// area.
struct LampLight32 {
  Eigen::Vector3f center, half_u, half_v, normal, radiance;
  float area = 0, inverse_u2 = 0, inverse_v2 = 0;

  explicit LampLight32(const AreaLight& lamp)
      : center(lamp.center.cast<float>()),
        half_u(lamp.half_u.cast<float>()),
        half_v(lamp.half_v.cast<float>()),
        normal(lamp.Normal().cast<float>()),
        radiance(lamp.radiance),
        area(static_cast<float>(lamp.Area())),
        inverse_u2(1 / half_u.squaredNorm()),
        inverse_v2(1 / half_v.squaredNorm()) {}

  struct Sample {
    Eigen::Vector3f direction;  ///< unit, towards the lamp
    float distance = 0;         ///< mm
    float density = 0;          ///< 1/sr; 0 behind the lamp
  };
  Sample Draw(const Eigen::Vector3f& point, float u1, float u2) const {
    const Eigen::Vector3f d = center + (2 * u1 - 1) * half_u + (2 * u2 - 1) * half_v - point;
    const float r2 = d.squaredNorm(), r = std::sqrt(r2), facing = -normal.dot(d);
    if (!(facing > 0)) return {};
    const float inverse = 1 / r;
    return {inverse * d, r, r2 * r / (facing * area)};
  }
  /// Distance (in lengths of the unit `direction`) at which a ray meets the front; 0 if it does
  /// not.
  float Meet(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const {
    const float facing = -normal.dot(direction);
    if (!(facing > 0)) return 0;
    const Eigen::Vector3f to_center = center - origin;
    const float t = -normal.dot(to_center) / facing;
    if (!(t > 0)) return 0;
    const Eigen::Vector3f in_plane = t * direction - to_center;
    if (std::abs(in_plane.dot(half_u)) * inverse_u2 > 1 ||
        std::abs(in_plane.dot(half_v)) * inverse_v2 > 1) {
      return 0;
    }
    return t;
  }
  /// Density of Draw in the direction of a ray that meets the front after `distance`.
  float Density(const Eigen::Vector3f& direction, float distance) const {
    return distance * distance / (-normal.dot(direction) * area);
  }
};

}  // namespace lfm
