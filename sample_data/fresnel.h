// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace lfm {

/// Unpolarised reflectance of a smooth boundary between dielectrics (Fresnel's equations);
/// `cos_o` >= 0 is the cosine on this side, `eta` the index beyond over the index on this side.
/// 1 where all is reflected. `cos_beyond`, when given, takes the refracted ray's cosine (0 then).
inline float DielectricFresnel(float cos_o, float eta, float* cos_beyond = nullptr) {
  const float c = std::min(1.0f, std::max(0.0f, cos_o));
  const float sin2 = (1 - c * c) / (eta * eta);
  if (sin2 >= 1) {
    if (cos_beyond != nullptr) *cos_beyond = 0;
    return 1;
  }
  const float t = std::sqrt(1 - sin2);
  if (cos_beyond != nullptr) *cos_beyond = t;
  const float parallel = (eta * c - t) / (eta * c + t);
  const float perpendicular = (c - eta * t) / (c + eta * t);
  return 0.5f * (parallel * parallel + perpendicular * perpendicular);
}

/// Schlick's approximation a channel: f0 + (1 - f0) (1 - cos)^5; `cos_h` is clamped to [0, 1].
inline Eigen::Vector3f SchlickColor(const Eigen::Vector3f& f0, float cos_h) {
  const float m = 1 - std::min(1.0f, std::max(0.0f, cos_h)), m2 = m * m;
  return f0 + (m2 * m2 * m) * (Eigen::Vector3f::Ones() - f0);
}

}  // namespace lfm
