// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sample_data/lanes/layer_lookup.h"

namespace lfm {
inline namespace LFM_LANE_SET {

/// Sheen of short fibres: the "Charlie" distribution of Estevez and Kulla 2017 ("Production
/// friendly microfacet sheen BRDF"), whose normals lie mostly across the surface,
///
///   D(h) = (2 + 1/r) sin(theta_h)^(1/r) / (2 pi),   f = D G / (4 (n.o)(n.i)),
///   G = 1 / (1 + Lambda(o) + Lambda(i)),
///
/// with the paper's fit of Lambda. Its softening of the terminator is left out, since that is not
/// reciprocal. Roughness r is clamped to [0.07, 1].
inline constexpr float kFuzzSmoothest = kLayerFuzzSmoothest;

template <typename F>
LFM_LANE F FuzzLambda(F cosine, F r) {
  const F t = (1.0f - r) * (1.0f - r);
  const F a = 21.5473f + t * (25.3245f - 21.5473f), b = 3.82987f + t * (3.32435f - 3.82987f);
  const F c = 0.19823f + t * (0.16801f - 0.19823f), d = -1.97760f + t * (1.97760f - 1.27393f);
  const F e = -4.32054f + t * (4.32054f - 4.85967f);
  const MaskOf<F> low = cosine < 0.5f;
  const F x = Select(low, cosine, 1.0f - cosine);
  const F fit = a / (1.0f + b * Pow(x, c)) + d * x + e;
  const F middle = a / (1.0f + b * Pow(Splat<F>(0.5f), c)) + d * 0.5f + e;
  return Exp(Select(low, fit, 2.0f * middle - fit));
}

/// f for a white sheen, 1/sr; 0 below the horizon.
template <typename F>
LFM_LANE F FuzzReflection(const Vec<F>& o, const Vec<F>& i, F alpha) {
  const MaskOf<F> above = (o.z > 1e-4f) & (i.z > 1e-4f);
  const F r = Clamp(alpha, kFuzzSmoothest, 1.0f);
  const Vec<F> h = UnitVector(o + i);
  const F sine2 = Max(1.0f - h.z * h.z, 0.0f);
  const F d = (2.0f + 1.0f / r) * Pow(sine2, 0.5f / r) / (2.0f * kLanePi);
  const F f = d / ((1.0f + FuzzLambda(o.z, r) + FuzzLambda(i.z, r)) * 4.0f * o.z * i.z);
  return Select(above, f, Splat<F>(0));
}

}  // namespace LFM_LANE_SET
}  // namespace lfm
