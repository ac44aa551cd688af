// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sample_data/lanes/lane_math.h"

namespace lfm {
inline namespace LFM_LANE_SET {

/// The anisotropic GGX distribution and its reflection in float32, for the path tracer's inner
/// loop; sample_data/ggx.h is the same in double for one roughness, and a test compares them.
///
///   D(h) = 1 / (pi au av ((hx/au)^2 + (hy/av)^2 + hz^2)^2)
///   f    = F D G2 / (4 (n.o)(n.i)) = F D / (2 (oz Si + iz So)),  S(w) = |(au wx, av wy, wz)|
///
/// with Smith's height-correlated G2 (Heitz 2014, equation 99, after S = (1 + 2 Lambda) |wz|).
/// Directions are unit, z is the normal, `au`, `av` in (0, 1]. Nothing here is NaN: what lies below
/// the horizon gives 0.

/// S(w) above.
template <typename F>
LFM_LANE F GgxStretch(const Vec<F>& w, F au, F av) {
  const F x = au * w.x, y = av * w.y;
  return Sqrt(x * x + y * y + w.z * w.z);
}

/// D(h), 1/sr.
template <typename F>
LFM_LANE F GgxNormals(const Vec<F>& h, F au, F av) {
  // Multiplied through by (au av)^2, for the sake of a single division.
  const F x = h.x * av, y = h.y * au, a = au * av, z = h.z * a;
  const F t = x * x + y * y + z * z;
  return Select(h.z > 0.0f, a * a * a / (kLanePi * t * t), Splat<F>(0));
}

/// Smith's G1 of a direction on either side.
template <typename F>
LFM_LANE F GgxVisible(const Vec<F>& w, F au, F av) {
  const F z = Abs(w.z);
  return Select(z > 0.0f, 2.0f * z / (z + GgxStretch(w, au, av)), Splat<F>(0));
}

/// Half vector from the distribution of normals visible from `o` (oz > 0), out of two uniform
/// numbers (Heitz 2018, section 3); its density is G1(o) D(h) (o.h) / oz.
template <typename F>
LFM_LANE Vec<F> SampleGgxNormal(const Vec<F>& o, F au, F av, F u1, F u2) {
  const Vec<F> s = UnitVector(Vec<F>{au * o.x, av * o.y, o.z});
  const F planar2 = s.x * s.x + s.y * s.y;
  const MaskOf<F> tilted = planar2 > 1e-14f;
  const F inverse = 1.0f / Sqrt(Select(tilted, planar2, Splat<F>(1)));
  const Vec<F> t1 = {Select(tilted, -s.y * inverse, Splat<F>(1)),
                     Select(tilted, s.x * inverse, Splat<F>(0)), Splat<F>(0)};
  const Vec<F> t2 = {-s.z * t1.y, s.z * t1.x, s.x * t1.y - s.y * t1.x};
  F sine, cosine;
  SinCosTurns(u2, sine, cosine);
  const F radius = Sqrt(u1), p1 = radius * cosine, k = 0.5f * (1.0f + s.z);
  const F p2 = (1.0f - k) * Sqrt(Max(1.0f - p1 * p1, 0.0f)) + k * radius * sine;
  const Vec<F> h = p1 * t1 + p2 * t2 + Sqrt(Max(1.0f - p1 * p1 - p2 * p2, 0.0f)) * s;
  return UnitVector(Vec<F>{au * h.x, av * h.y, Max(h.z, 1e-6f)});
}

/// What one reflection is worth: `value` = D G2 / (4 oz iz) (times F: the BRDF), `density` of the
/// reflected direction of SampleGgxNormal (1/sr), and the cosine (o.h) for the Fresnel term.
template <typename F>
struct GgxReflected {
  F value, density, cos_h;
};
template <typename F>
LFM_LANE GgxReflected<F> ReflectGgx(const Vec<F>& o, const Vec<F>& i, F au, F av) {
  const MaskOf<F> above = (o.z > 0.0f) & (i.z > 0.0f);
  const Vec<F> h = UnitVector(o + i);
  const F d = GgxNormals(h, au, av);
  const F so = GgxStretch(o, au, av), si = GgxStretch(i, au, av);
  const F zero = Splat<F>(0);
  return {Select(above, 0.5f * d / (o.z * si + i.z * so), zero),
          Select(above, 0.5f * d / (o.z + so), zero), Select(above, Dot(o, h), zero)};
}

}  // namespace LFM_LANE_SET
}  // namespace lfm
