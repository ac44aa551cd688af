// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/rough_glass.h"

#include <cmath>

#include "sample_data/fresnel.h"
#include "sample_data/microfacet.h"

// Walter, Marschner, Li and Torrance 2007, "Microfacet models for refraction through rough
// surfaces": half vector (equation 16), reflection (20), refraction (21). `eta` is the index beyond
// the boundary over the index on o's side; all is computed with o above.

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

V3f Flipped(const V3f& v, bool flip) { return flip ? V3f(v.x(), v.y(), -v.z()) : v; }

float EtaFrom(const Material& material, bool inside) {
  return inside ? 1 / material.ior : material.ior;
}

BsdfSample ClearGlass(float eta, const V3f& o, float u_lobe) {
  BsdfSample sample;
  sample.delta = true;
  float cos_beyond = 0;
  const float reflected = DielectricFresnel(o.z(), eta, &cos_beyond);
  sample.weight = V3f::Ones();
  if (u_lobe < reflected) {
    sample.direction = {-o.x(), -o.y(), o.z()};
  } else {
    sample.direction = V3f(-o.x() / eta, -o.y() / eta, -cos_beyond).normalized();
    sample.index_ratio2 = eta * eta;
    sample.weight /= eta * eta;
  }
  return sample;
}

BsdfValue EvaluateAbove(const Material& material, float eta, const V3f& o, const V3f& i) {
  const float alpha = material.alpha_u;
  if (i.z() > 0) {
    const GgxReflected r = ReflectGgx(o, i, alpha, alpha);
    const float fresnel = DielectricFresnel(r.cos_h, eta);
    return {V3f::Constant(fresnel * r.value * i.z()), fresnel * r.density};
  }
  if (!(i.z() < 0)) return {};
  V3f h = o + eta * i;
  const float length = h.norm();
  if (!(length > 1e-7f)) return {};
  h /= length;
  if (h.z() < 0) h = -h;
  const float oh = o.dot(h), ih = i.dot(h);
  if (!(oh > 0) || !(ih < 0)) return {};
  const float transmitted = 1 - DielectricFresnel(oh, eta);
  const float root = oh + eta * ih;
  // Density of h among the visible normals, times dh/di.
  const float visible = GgxVisible(o, alpha, alpha) * GgxNormals(h, alpha, alpha) * oh / o.z();
  const float density = transmitted * visible * eta * eta * -ih / (root * root);
  const float value = density * GgxVisible(i, alpha, alpha) / (eta * eta);
  return {V3f::Constant(value), density};
}

}  // namespace

bool GlassIsClear(const Material& material) {
  return material.alpha_u < kMirrorAlpha || std::abs(material.ior - 1) < 1e-3f;
}

BsdfValue EvaluateGlass(const Material& material, const V3f& o, const V3f& i) {
  if (GlassIsClear(material) || o.z() == 0) return {};
  const bool inside = o.z() < 0;
  return EvaluateAbove(material, EtaFrom(material, inside), Flipped(o, inside), Flipped(i, inside));
}

BsdfSample SampleGlass(const Material& material, const V3f& o, float u_lobe, float u1, float u2) {
  if (o.z() == 0) return {};
  const bool inside = o.z() < 0;
  const float eta = EtaFrom(material, inside);
  const V3f above = Flipped(o, inside);
  if (GlassIsClear(material)) {
    BsdfSample sample = ClearGlass(eta, above, u_lobe);
    sample.direction = Flipped(sample.direction, inside);
    return sample;
  }
  const V3f h = SampleGgxNormal(above, material.alpha_u, material.alpha_u, u1, u2);
  const float oh = above.dot(h);
  float cos_beyond = 0;
  const float reflected = DielectricFresnel(oh, eta, &cos_beyond);
  BsdfSample sample;
  V3f i;
  if (u_lobe < reflected) {
    i = 2 * oh * h - above;
    if (i.z() <= 0) return {};
  } else {
    i = (oh / eta - cos_beyond) * h - above / eta;
    if (i.z() >= 0) return {};
    sample.index_ratio2 = eta * eta;
  }
  i.normalize();
  const BsdfValue value = EvaluateAbove(material, eta, above, i);
  if (!(value.density > 0)) return {};
  sample.direction = Flipped(i, inside);
  sample.density = value.density;
  sample.weight = value.value / value.density;
  return sample;
}

}  // namespace lfm
