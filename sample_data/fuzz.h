// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace lfm {

/// Sheen of short fibres: the "Charlie" distribution of Estevez and Kulla 2017 ("Production
/// friendly microfacet sheen BRDF"), whose normals lie mostly across the surface,
///
///   D(h) = (2 + 1/r) sin(theta_h)^(1/r) / (2 pi),   f = D G / (4 (n.o)(n.i)),
///   G = 1 / (1 + Lambda(o) + Lambda(i)),
///
/// with the paper's fit of Lambda. Its softening of the terminator is left out, since that is not
/// reciprocal. Roughness r is clamped to [0.07, 1].
inline constexpr float kFuzzSmoothest = 0.07f;

inline float FuzzLambda(float cosine, float r) {
  const float t = (1 - r) * (1 - r);
  const auto mix = [t](float rough, float smooth) { return rough + t * (smooth - rough); };
  const float a = mix(21.5473f, 25.3245f), b = mix(3.82987f, 3.32435f), c = mix(0.19823f, 0.16801f);
  const float d = mix(-1.97760f, -1.27393f), e = mix(-4.32054f, -4.85967f);
  const auto fit = [&](float x) { return a / (1 + b * std::pow(x, c)) + d * x + e; };
  return cosine < 0.5f ? std::exp(fit(cosine)) : std::exp(2 * fit(0.5f) - fit(1 - cosine));
}

/// f for a white sheen, 1/sr; 0 below the horizon.
inline float FuzzReflection(const Eigen::Vector3f& o, const Eigen::Vector3f& i, float alpha) {
  if (!(o.z() > 1e-4f) || !(i.z() > 1e-4f)) return 0;
  const float r = std::clamp(alpha, kFuzzSmoothest, 1.0f);
  const Eigen::Vector3f h = (o + i).normalized();
  const float sine2 = std::max(0.0f, 1 - h.z() * h.z());
  const float d = (2 + 1 / r) * std::pow(sine2, 0.5f / r) / (2 * std::numbers::pi_v<float>);
  return d / ((1 + FuzzLambda(o.z(), r) + FuzzLambda(i.z(), r)) * 4 * o.z() * i.z());
}

}  // namespace lfm
