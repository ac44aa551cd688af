// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sample_data/lanes/fresnel.h"
#include "sample_data/lanes/fuzz.h"
#include "sample_data/lanes/layer_lookup.h"
#include "sample_data/lanes/microfacet.h"

namespace lfm {

/// The values of MaterialKind.
inline constexpr int32_t kLaneLambert = 0, kLanePhong = 1, kLaneConductor = 2, kLanePaint = 3,
                         kLanePlastic = 4, kLaneGlass = 5, kLaneFuzz = 6;
inline constexpr float kLaneMirrorAlpha = 1e-3f;

inline namespace LFM_LANE_SET {

/// sample_data/bsdf.h states the formulas and what the arguments mean.
template <typename F>
struct LaneMaterial {
  IntOf<F> kind;
  Vec<F> diffuse, specular;
  F exponent, alpha_u, alpha_v, ior;
  Vec<F> absorption;
};
template <typename F>
struct LaneBsdf {
  Vec<F> value = Gray(Splat<F>(0));
  F density = Splat<F>(0);
};
template <typename F>
struct LaneSample {
  Vec<F> direction = {Splat<F>(0), Splat<F>(0), Splat<F>(1)};
  Vec<F> weight = Gray(Splat<F>(0));
  F density = Splat<F>(0);
  IntOf<F> delta = {};  ///< 0 or -1
  F index_ratio2 = Splat<F>(1);
};

inline constexpr float kLaneInversePi = 1 / kLanePi;

template <typename F>
LFM_LANE F Brightness(const Vec<F>& color) {
  return (color.x + color.y + color.z) * (1 / 3.0f);
}

// Share of samples for a lobe of brightness `a` beside another of `b`.
template <typename F>
LFM_LANE F LobeShare(F a, F b) {
  const F share = Clamp(a / (a + b), 0.1f, 0.9f);
  return Select(a > 0.0f, Select(b > 0.0f, share, Splat<F>(1)), Splat<F>(0));
}

template <typename F>
LFM_LANE Vec<F> CosineDirection(F u1, F u2) {
  F sine, cosine;
  SinCosTurns(u2, sine, cosine);
  const F radius = Sqrt(u1);
  return {radius * cosine, radius * sine, Sqrt(Max(1.0f - u1, 1e-9f))};
}

template <typename F>
LFM_LANE Vec<F> HemisphereDirection(F u1, F u2) {
  F sine, cosine;
  SinCosTurns(u2, sine, cosine);
  const F z = 1.0f - u1, s = Sqrt(Max(1.0f - z * z, 0.0f));
  return {s * cosine, s * sine, z};
}

template <typename F>
LFM_LANE Vec<F> Mirrored(const Vec<F>& o) {
  return {-o.x, -o.y, o.z};
}

// cos^s of the angle between unit vectors, exact for s up to 1e5 and beyond: 1 - cos is half the
// squared distance.
template <typename F>
LFM_LANE F PowerOfCosine(const Vec<F>& a, const Vec<F>& b, F exponent) {
  const F missing = 0.5f * Dot(a - b, a - b);
  const MaskOf<F> lit = missing < 1.0f;
  return Select(lit, Exp(exponent * Log1p(-Select(lit, missing, Splat<F>(0)))), Splat<F>(0));
}

template <typename F>
LFM_LANE MaskOf<F> SmoothCoat(const LaneMaterial<F>& m) {
  return Max(m.alpha_u, m.alpha_v) < kLaneMirrorAlpha;
}
template <typename F>
LFM_LANE F AlphaU(const LaneMaterial<F>& m) {
  return Max(m.alpha_u, kLaneMirrorAlpha);
}
template <typename F>
LFM_LANE F AlphaV(const LaneMaterial<F>& m) {
  return Max(m.alpha_v, kLaneMirrorAlpha);
}

// What is left to the base under the coat of a paint.
template <typename F>
LFM_LANE Vec<F> PaintBase(const LaneMaterial<F>& m) {
  const F one = Splat<F>(1);
  return Times(m.diffuse, Gray(one) - m.specular);
}

// The plastic's coat at cosine c: its albedo, exact where it is smooth.
template <typename F>
LFM_LANE F CoatAlbedo(const LayerTables& tables, const LaneMaterial<F>& m, F c) {
  const F rough = DielectricAlbedoAt(tables, m.ior, Sqrt(AlphaU(m) * AlphaV(m)), c);
  return Select(SmoothCoat(m), DielectricFresnel(c, m.ior), rough);
}
template <typename F>
LFM_LANE F CoatMean(const LayerTables& tables, const LaneMaterial<F>& m) {
  const F alpha = Select(SmoothCoat(m), Splat<F>(0), Sqrt(AlphaU(m) * AlphaV(m)));
  return DielectricAlbedoMean(tables, m.ior, alpha);
}

template <typename F>
LFM_LANE F PhongShare(const LaneMaterial<F>& m) {
  return LobeShare(Brightness(m.specular), Brightness(m.diffuse));
}
template <typename F>
LFM_LANE F PaintShare(const LaneMaterial<F>& m, const Vec<F>& o) {
  return LobeShare(Brightness(SchlickColor(m.specular, o.z)), Brightness(PaintBase(m)));
}
template <typename F>
LFM_LANE F PlasticShare(const LaneMaterial<F>& m, F coat_albedo) {
  return LobeShare(coat_albedo, (1.0f - coat_albedo) * Brightness(m.diffuse));
}
template <typename F>
LFM_LANE F FuzzShare(const LaneMaterial<F>& m, F fuzz_albedo) {
  const F color = LargestOf(m.specular);
  return LobeShare(fuzz_albedo * Brightness(m.specular),
                   (1.0f - color * fuzz_albedo) * Brightness(m.diffuse));
}

template <typename F>
LFM_LANE LaneBsdf<F> EvaluateLambert(const LaneMaterial<F>& m, const Vec<F>& i) {
  const F cosine = i.z * kLaneInversePi;
  return {cosine * m.diffuse, cosine};
}

template <typename F>
LFM_LANE_CALL LaneBsdf<F> EvaluatePhong(const LaneMaterial<F>& m, const Vec<F>& o,
                                        const Vec<F>& i) {
  const F lobe = PowerOfCosine(Mirrored(o), i, m.exponent) / (2.0f * kLanePi);
  const F share = PhongShare(m), scale = (m.exponent + 2.0f) * lobe;
  const Vec<F> f = Splat<F>(kLaneInversePi) * m.diffuse + scale * m.specular;
  return {i.z * f, share * (m.exponent + 1.0f) * lobe + (1.0f - share) * i.z * kLaneInversePi};
}

template <typename F>
LFM_LANE_CALL LaneBsdf<F> EvaluateConductor(const LaneMaterial<F>& m, const Vec<F>& o,
                                            const Vec<F>& i) {
  const GgxReflected<F> r = ReflectGgx(o, i, AlphaU(m), AlphaV(m));
  const MaskOf<F> rough = !SmoothCoat(m);
  return {Select(rough, r.value * i.z, Splat<F>(0)) * SchlickColor(m.specular, r.cos_h),
          Select(rough, r.density, Splat<F>(0))};
}

template <typename F>
LFM_LANE LaneBsdf<F> EvaluatePaint(const LaneMaterial<F>& m, const Vec<F>& o, const Vec<F>& i) {
  const F share = PaintShare(m, o), alpha = AlphaU(m);
  const GgxReflected<F> r = ReflectGgx(o, i, alpha, alpha);
  const Vec<F> f =
      Splat<F>(kLaneInversePi) * PaintBase(m) + r.value * SchlickColor(m.specular, r.cos_h);
  return {i.z * f, share * r.density + (1.0f - share) * i.z * kLaneInversePi};
}

template <typename F>
LFM_LANE_CALL LaneBsdf<F> EvaluatePlastic(const LayerTables& tables, const LaneMaterial<F>& m,
                                          const Vec<F>& o, const Vec<F>& i) {
  const F eo = CoatAlbedo(tables, m, o.z), share = PlasticShare(m, eo);
  const F base =
      (1.0f - eo) * (1.0f - CoatAlbedo(tables, m, i.z)) / (kLanePi * (1.0f - CoatMean(tables, m)));
  const GgxReflected<F> r = ReflectGgx(o, i, AlphaU(m), AlphaV(m));
  const F coat =
      Select(SmoothCoat(m), Splat<F>(0), i.z * r.value * DielectricFresnel(r.cos_h, m.ior));
  return {i.z * base * m.diffuse + Gray(coat),
          (1.0f - share) * i.z * kLaneInversePi +
              Select(SmoothCoat(m), Splat<F>(0), share * r.density)};
}

template <typename F>
LFM_LANE_CALL LaneBsdf<F> EvaluateFuzz(const LayerTables& tables, const LaneMaterial<F>& m,
                                       const Vec<F>& o, const Vec<F>& i) {
  const F color = LargestOf(m.specular);
  const F eo = FuzzAlbedoAt(tables, m.alpha_u, o.z), share = FuzzShare(m, eo);
  const F left = 1.0f - color * FuzzAlbedoMean(tables, m.alpha_u);
  const F base = (1.0f - color * eo) * (1.0f - color * FuzzAlbedoAt(tables, m.alpha_u, i.z)) /
                 (kLanePi * Max(left, 1e-3f));
  return {i.z * (base * m.diffuse + FuzzReflection(o, i, m.alpha_u) * m.specular),
          share / (2.0f * kLanePi) + (1.0f - share) * i.z * kLaneInversePi};
}

template <typename F>
LFM_LANE void Blend(MaskOf<F> mask, const LaneBsdf<F>& from, LaneBsdf<F>& into) {
  into.value = Select(mask, from.value, into.value);
  into.density = Select(mask, from.density, into.density);
}

}  // namespace LFM_LANE_SET
}  // namespace lfm
