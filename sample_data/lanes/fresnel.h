// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sample_data/lanes/lane_math.h"

namespace lfm {
inline namespace LFM_LANE_SET {

/// Unpolarised reflectance of a smooth boundary between dielectrics (Fresnel's equations), and the
/// cosine of the refracted ray; `cos_o` >= 0 is the cosine on this side, `eta` the index beyond
/// over the index on this side. 1 and 0 where all is reflected.
template <typename F>
struct DielectricBoundary {
  F reflected, cos_beyond;
};
template <typename F>
LFM_LANE DielectricBoundary<F> MeetDielectric(F cos_o, F eta) {
  const F c = Clamp(cos_o, 0.0f, 1.0f);
  const F sin2 = (1.0f - c * c) / (eta * eta);
  const F t = Sqrt(Max(1.0f - sin2, 0.0f));
  const F parallel = (eta * c - t) / (eta * c + t);
  const F perpendicular = (c - eta * t) / (c + eta * t);
  const F reflected = 0.5f * (parallel * parallel + perpendicular * perpendicular);
  const MaskOf<F> all = sin2 >= 1.0f;
  return {Select(all, Splat<F>(1), reflected), Select(all, Splat<F>(0), t)};
}
template <typename F>
LFM_LANE F DielectricFresnel(F cos_o, F eta) {
  return MeetDielectric(cos_o, eta).reflected;
}

/// Schlick's approximation a channel: f0 + (1 - f0) (1 - cos)^5; `cos_h` is clamped to [0, 1].
template <typename F>
LFM_LANE Vec<F> SchlickColor(const Vec<F>& f0, F cos_h) {
  const F m = 1.0f - Clamp(cos_h, 0.0f, 1.0f), m2 = m * m, m5 = m2 * m2 * m;
  return {f0.x + m5 * (1.0f - f0.x), f0.y + m5 * (1.0f - f0.y), f0.z + m5 * (1.0f - f0.z)};
}

}  // namespace LFM_LANE_SET
}  // namespace lfm
