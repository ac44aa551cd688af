// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sample_data/lanes/lane_bsdf.h"
#include "sample_data/lanes/lane_glass.h"

namespace lfm {
inline namespace LFM_LANE_SET {

/// EvaluateBsdf of sample_data/bsdf.h, where every lane may have another kind of material.
template <typename F>
LFM_LANE_CALL LaneBsdf<F> EvaluateLanes(const LayerTables& tables, const LaneMaterial<F>& m,
                                        const Vec<F>& o, const Vec<F>& i) {
  LaneBsdf<F> result;
  const MaskOf<F> above = (o.z > 0.0f) & (i.z > 0.0f);
  const auto is = [&](int32_t kind) -> MaskOf<F> { return above & (m.kind == kind); };
  if (const auto here = is(kLaneLambert); Any(here)) Blend<F>(here, EvaluateLambert(m, i), result);
  if (const auto here = is(kLanePaint); Any(here)) Blend<F>(here, EvaluatePaint(m, o, i), result);
  if (const auto here = is(kLanePhong); Any(here)) Blend<F>(here, EvaluatePhong(m, o, i), result);
  if (const auto here = is(kLaneConductor); Any(here)) {
    Blend<F>(here, EvaluateConductor(m, o, i), result);
  }
  if (const auto here = is(kLanePlastic); Any(here)) {
    Blend<F>(here, EvaluatePlastic(tables, m, o, i), result);
  }
  if (const auto here = is(kLaneFuzz); Any(here)) {
    Blend<F>(here, EvaluateFuzz(tables, m, o, i), result);
  }
  if (const MaskOf<F> here = m.kind == kLaneGlass; Any(here)) {
    Blend<F>(here, EvaluateGlass(m, o, i), result);
  }
  return result;
}

template <typename F>
LFM_LANE_CALL Vec<F> PhongDirection(const LaneMaterial<F>& m, const Vec<F>& o, const F& u1,
                                    const F& u2) {
  // 1 - cos = 1 - u^(1 / (s + 1)), without cancellation.
  const F missing = -Expm1(Log1p(-u1) / (m.exponent + 1.0f)), zero = Splat<F>(0);
  const F s = Sqrt(Max(missing * (2.0f - missing), 0.0f));
  F sine, cosine;
  SinCosTurns(u2, sine, cosine);
  const Vec<F> r = Mirrored(o);
  const MaskOf<F> flat = Abs(r.z) < 0.9f;
  const Vec<F> t = UnitVector(Select<F>(flat, {r.y, -r.x, zero}, {zero, r.z, -r.y}));
  return UnitVector((1.0f - missing) * r + s * cosine * t + s * sine * Cross(r, t));
}

/// Probability that the lobe other than the diffuse one is drawn.
template <typename F>
LFM_LANE F SpecularShare(const LayerTables& tables, const LaneMaterial<F>& m, const Vec<F>& o) {
  F share = Splat<F>(0);
  const auto take = [&](int32_t kind, auto&& of) {
    const MaskOf<F> here = m.kind == kind;
    if (Any(here)) share = Select(here, of(), share);
  };
  take(kLanePaint, [&] { return PaintShare(m, o); });
  take(kLanePhong, [&] { return PhongShare(m); });
  take(kLaneConductor, [&] { return Splat<F>(1); });
  take(kLanePlastic, [&] { return PlasticShare(m, CoatAlbedo(tables, m, o.z)); });
  take(kLaneFuzz, [&] { return FuzzShare(m, FuzzAlbedoAt(tables, m.alpha_u, o.z)); });
  return share;
}

template <typename F>
LFM_LANE LaneSample<F> SampleOpaque(const LayerTables& tables, const LaneMaterial<F>& m,
                                    const Vec<F>& o, F u_lobe, F u1, F u2) {
  const F zero = Splat<F>(0), share = SpecularShare(tables, m, o);
  const MaskOf<F> specular = u_lobe < share;
  LaneSample<F> sample;
  sample.direction = CosineDirection(u1, u2);
  if (Any(specular)) {
    const MaskOf<F> phong = m.kind == kLanePhong, fuzz = m.kind == kLaneFuzz;
    const F av = Select(m.kind == kLanePaint, AlphaU(m), AlphaV(m));
    const Vec<F> h = SampleGgxNormal(o, AlphaU(m), av, u1, u2);
    Vec<F> direction = UnitVector(2.0f * Dot(o, h) * h - o);
    if (Any(phong)) direction = Select<F>(phong, PhongDirection(m, o, u1, u2), direction);
    if (Any(fuzz)) direction = Select<F>(fuzz, HemisphereDirection(u1, u2), direction);
    sample.direction = Select<F>(specular, direction, sample.direction);
  }
  const LaneBsdf<F> value = EvaluateLanes(tables, m, o, sample.direction);
  const MaskOf<F> drawn = (o.z > 0.0f) & (value.density > 0.0f);
  sample.density = Select(drawn, value.density, zero);
  sample.weight = Select<F>(drawn, (1.0f / value.density) * value.value, Gray(zero));
  const MaskOf<F> lambert = drawn & (m.kind == kLaneLambert);
  sample.weight = Select<F>(lambert, m.diffuse, sample.weight);

  const MaskOf<F> coated = (m.kind == kLaneConductor) | (m.kind == kLanePlastic);
  const MaskOf<F> mirror = coated & specular & SmoothCoat(m) & (o.z > 0.0f);
  if (Any(mirror)) {
    const Vec<F> coat = Gray(DielectricFresnel(o.z, m.ior) / share);
    const Vec<F> metal = SchlickColor(m.specular, o.z);
    sample.direction = Select<F>(mirror, Mirrored(o), sample.direction);
    sample.weight =
        Select<F>(mirror, Select<F>(m.kind == kLaneConductor, metal, coat), sample.weight);
    sample.density = Select(mirror, zero, sample.density);
    sample.delta = Select(mirror, SplatInt<IntOf<F>>(-1), sample.delta);
  }
  return sample;
}

/// SampleBsdf of sample_data/bsdf.h.
template <typename F>
LFM_LANE LaneSample<F> SampleLanes(const LayerTables& tables, const LaneMaterial<F>& m,
                                   const Vec<F>& o, F u_lobe, F u1, F u2) {
  const MaskOf<F> glass = m.kind == kLaneGlass;
  if (All(glass)) return SampleGlass(m, o, u_lobe, u1, u2);
  LaneSample<F> sample = SampleOpaque(tables, m, o, u_lobe, u1, u2);
  if (!Any(glass)) return sample;
  const LaneSample<F> through = SampleGlass(m, o, u_lobe, u1, u2);
  sample.direction = Select<F>(glass, through.direction, sample.direction);
  sample.weight = Select<F>(glass, through.weight, sample.weight);
  sample.density = Select(glass, through.density, sample.density);
  sample.delta = Select(glass, through.delta, sample.delta);
  sample.index_ratio2 = Select(glass, through.index_ratio2, sample.index_ratio2);
  return sample;
}

/// True where a material has delta lobes only.
template <typename F>
LFM_LANE MaskOf<F> IsDeltaLane(const LaneMaterial<F>& m) {
  return ((m.kind == kLaneGlass) & GlassIsClear(m)) | ((m.kind == kLaneConductor) & SmoothCoat(m));
}

}  // namespace LFM_LANE_SET
}  // namespace lfm
