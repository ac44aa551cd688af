// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sample_data/lanes/lane_bsdf.h"

// Walter, Marschner, Li and Torrance 2007, "Microfacet models for refraction through rough
// surfaces": half vector (equation 16), reflection (20), refraction (21). `eta` is the index beyond
// the boundary over the index on o's side; all is computed with o above.
namespace lfm {
inline namespace LFM_LANE_SET {

template <typename F>
LFM_LANE MaskOf<F> GlassIsClear(const LaneMaterial<F>& m) {
  return (m.alpha_u < kLaneMirrorAlpha) | (Abs(m.ior - 1.0f) < 1e-3f);
}

template <typename F>
LFM_LANE Vec<F> Flipped(const Vec<F>& v, MaskOf<F> flip) {
  return {v.x, v.y, Select(flip, -v.z, v.z)};
}
template <typename F>
LFM_LANE F EtaFrom(const LaneMaterial<F>& m, MaskOf<F> inside) {
  return Select(inside, 1.0f / m.ior, m.ior);
}

template <typename F>
LFM_LANE_CALL LaneBsdf<F> EvaluateGlassAbove(const LaneMaterial<F>& m, const F& eta,
                                             const Vec<F>& o, const Vec<F>& i) {
  const F alpha = AlphaU(m), zero = Splat<F>(0);
  const GgxReflected<F> r = ReflectGgx(o, i, alpha, alpha);
  const F fresnel = DielectricFresnel(r.cos_h, eta);
  const MaskOf<F> above = i.z > 0.0f;
  Vec<F> h = o + eta * i;
  const F length = Sqrt(Dot(h, h));
  h = (Select(h.z < 0.0f, Splat<F>(-1), Splat<F>(1)) / Max(length, 1e-7f)) * h;
  const F oh = Dot(o, h), ih = Dot(i, h);
  const MaskOf<F> through = (i.z < 0.0f) & (length > 1e-7f) & (oh > 0.0f) & (ih < 0.0f);
  const F transmitted = 1.0f - DielectricFresnel(oh, eta);
  const F root = oh + eta * ih;
  // Density of h among the visible normals, times dh/di.
  const F visible = GgxVisible(o, alpha, alpha) * GgxNormals(h, alpha, alpha) * oh / o.z;
  const F density = transmitted * visible * eta * eta * -ih / (root * root);
  const F value = density * GgxVisible(i, alpha, alpha) / (eta * eta);
  return {Gray(Select(above, fresnel * r.value * i.z, Select(through, value, zero))),
          Select(above, fresnel * r.density, Select(through, density, zero))};
}

template <typename F>
LFM_LANE LaneBsdf<F> EvaluateGlass(const LaneMaterial<F>& m, const Vec<F>& o, const Vec<F>& i) {
  const MaskOf<F> inside = o.z < 0.0f;
  LaneBsdf<F> result;
  Blend<F>(
      (!GlassIsClear(m)) & (o.z != 0.0f),
      EvaluateGlassAbove(m, EtaFrom<F>(m, inside), Flipped<F>(o, inside), Flipped<F>(i, inside)),
      result);
  return result;
}

template <typename F>
LFM_LANE_CALL LaneSample<F> SampleGlass(const LaneMaterial<F>& m, const Vec<F>& o, const F& u_lobe,
                                        const F& u1, const F& u2) {
  const MaskOf<F> inside = o.z < 0.0f, clear = GlassIsClear(m);
  const F eta = EtaFrom<F>(m, inside), zero = Splat<F>(0);
  const Vec<F> above = Flipped<F>(o, inside);
  Vec<F> h = {zero, zero, Splat<F>(1)};
  if (!All(clear)) h = Select<F>(clear, h, SampleGgxNormal(above, AlphaU(m), AlphaU(m), u1, u2));
  const F oh = Dot(above, h);
  const DielectricBoundary<F> boundary = MeetDielectric(oh, eta);
  const MaskOf<F> reflect = u_lobe < boundary.reflected;
  const Vec<F> mirrored = 2.0f * oh * h - above;
  const Vec<F> refracted = (oh / eta - boundary.cos_beyond) * h - (1.0f / eta) * above;
  const Vec<F> i = UnitVector(Select<F>(reflect, mirrored, refracted));
  LaneSample<F> sample;
  sample.direction = Flipped<F>(i, inside);
  sample.index_ratio2 = Select(reflect, Splat<F>(1), eta * eta);
  LaneBsdf<F> value;
  if (!All(clear)) value = EvaluateGlassAbove(m, eta, above, i);
  // A rough boundary may throw a ray to the wrong side: nothing is drawn then.
  const MaskOf<F> right = Select(reflect, i.z, -i.z) > 0.0f;
  const MaskOf<F> drawn = (o.z != 0.0f) & (clear | (right & (value.density > 0.0f)));
  sample.density = Select(clear | !drawn, zero, value.density);
  const Vec<F> clear_weight = Gray(1.0f / sample.index_ratio2);
  const Vec<F> rough_weight = (1.0f / Select(drawn, value.density, Splat<F>(1))) * value.value;
  sample.weight = Select<F>(drawn, Select<F>(clear, clear_weight, rough_weight), Gray(zero));
  sample.delta = Select(clear & drawn, SplatInt<IntOf<F>>(-1), SplatInt<IntOf<F>>(0));
  return sample;
}

}  // namespace LFM_LANE_SET
}  // namespace lfm
