// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace lfm {

/// The anisotropic GGX distribution and its reflection in float32, for the path tracer's inner
/// loop; sample_data/ggx.h is the same in double for one roughness, and a test compares them.
///
///   D(h) = 1 / (pi au av ((hx/au)^2 + (hy/av)^2 + hz^2)^2)
///   f    = F D G2 / (4 (n.o)(n.i)) = F D / (2 (oz Si + iz So)),  S(w) = |(au wx, av wy, wz)|
///
/// with Smith's height-correlated G2 (Heitz 2014, equation 99, after S = (1 + 2 Lambda) |wz|).
/// Directions are unit, z is the normal, `au`, `av` in (0, 1]. Nothing here is NaN: what lies below
/// the horizon gives 0.

/// `v` at length 1 (one division, where Eigen takes three).
inline Eigen::Vector3f UnitVector(const Eigen::Vector3f& v) {
  return (1 / std::sqrt(v.squaredNorm())) * v;
}

/// S(w) above.
inline float GgxStretch(const Eigen::Vector3f& w, float au, float av) {
  const float x = au * w.x(), y = av * w.y();
  return std::sqrt(x * x + y * y + w.z() * w.z());
}

/// D(h), 1/sr.
inline float GgxNormals(const Eigen::Vector3f& h, float au, float av) {
  if (!(h.z() > 0)) return 0;
  // Multiplied through by (au av)^2, for the sake of a single division.
  const float x = h.x() * av, y = h.y() * au, a = au * av, z = h.z() * a;
  const float t = x * x + y * y + z * z;
  return a * a * a / (std::numbers::pi_v<float> * t * t);
}

/// Smith's G1 of a direction on either side.
inline float GgxVisible(const Eigen::Vector3f& w, float au, float av) {
  const float z = std::abs(w.z());
  return z > 0 ? 2 * z / (z + GgxStretch(w, au, av)) : 0;
}

/// Half vector from the distribution of normals visible from `o` (oz > 0), out of two uniform
/// numbers (Heitz 2018, section 3); its density is G1(o) D(h) (o.h) / oz.
inline Eigen::Vector3f SampleGgxNormal(const Eigen::Vector3f& o, float au, float av, float u1,
                                       float u2) {
  using V3f = Eigen::Vector3f;
  const V3f s = UnitVector(V3f(au * o.x(), av * o.y(), o.z()));
  const float planar2 = s.x() * s.x() + s.y() * s.y();
  const float inverse = planar2 > 1e-14f ? 1 / std::sqrt(planar2) : 0;
  const V3f t1 = inverse > 0 ? V3f(-s.y() * inverse, s.x() * inverse, 0) : V3f(1, 0, 0);
  const V3f t2(-s.z() * t1.y(), s.z() * t1.x(), s.x() * t1.y() - s.y() * t1.x());
  const float radius = std::sqrt(u1), angle = 2 * std::numbers::pi_v<float> * u2;
  const float p1 = radius * std::cos(angle);
  const float k = 0.5f * (1 + s.z());
  const float p2 = (1 - k) * std::sqrt(std::max(0.0f, 1 - p1 * p1)) + k * radius * std::sin(angle);
  const V3f h = p1 * t1 + p2 * t2 + std::sqrt(std::max(0.0f, 1 - p1 * p1 - p2 * p2)) * s;
  return UnitVector(V3f(au * h.x(), av * h.y(), std::max(1e-6f, h.z())));
}

/// What one reflection is worth: `value` = D G2 / (4 oz iz) (times F: the BRDF), `density` of the
/// reflected direction of SampleGgxNormal (1/sr), and the cosine (o.h) for the Fresnel term.
struct GgxReflected {
  float value = 0, density = 0, cos_h = 0;
};
inline GgxReflected ReflectGgx(const Eigen::Vector3f& o, const Eigen::Vector3f& i, float au,
                               float av) {
  if (!(o.z() > 0) || !(i.z() > 0)) return {};
  const Eigen::Vector3f h = UnitVector(o + i);
  const float d = GgxNormals(h, au, av);
  const float so = GgxStretch(o, au, av), si = GgxStretch(i, au, av);
  return {0.5f * d / (o.z() * si + i.z() * so), 0.5f * d / (o.z() + so), o.dot(h)};
}

}  // namespace lfm
