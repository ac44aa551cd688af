// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/bsdf.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "sample_data/fresnel.h"
#include "sample_data/fuzz.h"
#include "sample_data/layer_albedo.h"
#include "sample_data/microfacet.h"
#include "sample_data/rough_glass.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr float kPi = std::numbers::pi_v<float>, kInversePi = 1 / kPi;

float Brightness(const V3f& color) { return (color.x() + color.y() + color.z()) / 3; }

// Share of samples for a lobe of brightness `a` beside another of `b`.
float LobeShare(float a, float b) {
  if (!(a > 0)) return 0;
  if (!(b > 0)) return 1;
  return std::clamp(a / (a + b), 0.1f, 0.9f);
}

V3f CosineDirection(float u1, float u2) {
  const float radius = std::sqrt(u1), angle = 2 * kPi * u2;
  return {radius * std::cos(angle), radius * std::sin(angle), std::sqrt(std::max(1e-9f, 1 - u1))};
}

V3f HemisphereDirection(float u1, float u2) {
  const float z = 1 - u1, s = std::sqrt(std::max(0.0f, 1 - z * z));
  const float angle = 2 * kPi * u2;
  return {s * std::cos(angle), s * std::sin(angle), z};
}

V3f Mirrored(const V3f& o) { return {-o.x(), -o.y(), o.z()}; }

// cos^s of the angle between unit vectors, exact for s up to 1e5 and beyond: 1 - cos is half the
// squared distance.
float PowerOfCosine(const V3f& a, const V3f& b, float exponent) {
  const float missing = 0.5f * (a - b).squaredNorm();
  if (!(missing < 1)) return 0;
  return std::exp(exponent * std::log1p(-missing));
}

BsdfValue EvaluateLambert(const V3f& albedo, const V3f& i) {
  return {i.z() * kInversePi * albedo, i.z() * kInversePi};
}

float PhongShare(const Material& m) {
  return LobeShare(Brightness(m.specular), Brightness(m.diffuse));
}

BsdfValue EvaluatePhong(const Material& m, const V3f& o, const V3f& i) {
  const float lobe = PowerOfCosine(Mirrored(o), i, m.exponent) / (2 * kPi);
  const float share = PhongShare(m);
  const V3f f = kInversePi * m.diffuse + (m.exponent + 2) * lobe * m.specular;
  return {i.z() * f, share * (m.exponent + 1) * lobe + (1 - share) * i.z() * kInversePi};
}

V3f PhongDirection(const Material& m, const V3f& o, float u1, float u2) {
  // 1 - cos = 1 - u^(1 / (s + 1)), without cancellation.
  const float missing = -std::expm1(std::log1p(-u1) / (m.exponent + 1));
  const float s = std::sqrt(std::max(0.0f, missing * (2 - missing))), angle = 2 * kPi * u2;
  const V3f r = Mirrored(o);
  const V3f t = std::abs(r.z()) < 0.9f ? V3f(r.y(), -r.x(), 0).normalized()
                                       : V3f(0, r.z(), -r.y()).normalized();
  return ((1 - missing) * r + s * std::cos(angle) * t + s * std::sin(angle) * r.cross(t))
      .normalized();
}

bool SmoothCoat(const Material& m) { return std::max(m.alpha_u, m.alpha_v) < kMirrorAlpha; }
float AlphaU(const Material& m) { return std::max(m.alpha_u, kMirrorAlpha); }
float AlphaV(const Material& m) { return std::max(m.alpha_v, kMirrorAlpha); }

BsdfValue EvaluateConductor(const Material& m, const V3f& o, const V3f& i) {
  if (SmoothCoat(m)) return {};
  const GgxReflected r = ReflectGgx(o, i, AlphaU(m), AlphaV(m));
  return {(r.value * i.z()) * SchlickColor(m.specular, r.cos_h), r.density};
}

float PaintShare(const Material& m, const V3f& o) {
  const float coat = Brightness(SchlickColor(m.specular, o.z()));
  return LobeShare(coat, Brightness(m.diffuse.cwiseProduct(V3f::Ones() - m.specular)));
}

BsdfValue EvaluatePaint(const Material& m, const V3f& o, const V3f& i) {
  const float share = PaintShare(m, o), alpha = AlphaU(m);
  const V3f base = m.diffuse.cwiseProduct(V3f::Ones() - m.specular);
  const GgxReflected r = ReflectGgx(o, i, alpha, alpha);
  return {i.z() * (kInversePi * base + r.value * SchlickColor(m.specular, r.cos_h)),
          share * r.density + (1 - share) * i.z() * kInversePi};
}

// The plastic's coat at cosine c: its albedo, exact where it is smooth.
float CoatAlbedo(const Material& m, float c) {
  if (SmoothCoat(m)) return DielectricFresnel(c, m.ior);
  return DielectricAlbedoTable().At(m.ior, std::sqrt(AlphaU(m) * AlphaV(m)), c);
}
float CoatMean(const Material& m) {
  return DielectricAlbedoTable().Mean(m.ior, SmoothCoat(m) ? 0 : std::sqrt(AlphaU(m) * AlphaV(m)));
}

float PlasticShare(const Material& m, float coat_albedo) {
  return LobeShare(coat_albedo, (1 - coat_albedo) * Brightness(m.diffuse));
}

BsdfValue EvaluatePlastic(const Material& m, const V3f& o, const V3f& i) {
  const float eo = CoatAlbedo(m, o.z()), share = PlasticShare(m, eo);
  const float base = (1 - eo) * (1 - CoatAlbedo(m, i.z())) / (kPi * (1 - CoatMean(m)));
  BsdfValue result{i.z() * base * m.diffuse, (1 - share) * i.z() * kInversePi};
  if (!SmoothCoat(m)) {
    const GgxReflected r = ReflectGgx(o, i, AlphaU(m), AlphaV(m));
    result.value += V3f::Constant(i.z() * r.value * DielectricFresnel(r.cos_h, m.ior));
    result.density += share * r.density;
  }
  return result;
}

float FuzzShare(const Material& m, float fuzz_albedo) {
  const float color = m.specular.maxCoeff();
  return LobeShare(fuzz_albedo * Brightness(m.specular),
                   (1 - color * fuzz_albedo) * Brightness(m.diffuse));
}

BsdfValue EvaluateFuzz(const Material& m, const V3f& o, const V3f& i) {
  const FuzzAlbedo& table = FuzzAlbedoTable();
  const float color = m.specular.maxCoeff();
  const float eo = table.At(m.alpha_u, o.z()), share = FuzzShare(m, eo);
  const float base = (1 - color * eo) * (1 - color * table.At(m.alpha_u, i.z())) /
                     (kPi * std::max(1e-3f, 1 - color * table.Mean(m.alpha_u)));
  return {i.z() * (base * m.diffuse + FuzzReflection(o, i, m.alpha_u) * m.specular),
          share / (2 * kPi) + (1 - share) * i.z() * kInversePi};
}

BsdfSample MirrorSample(const V3f& o, const V3f& weight) {
  BsdfSample sample;
  sample.direction = Mirrored(o);
  sample.weight = weight;
  sample.delta = true;
  return sample;
}

// Probability that the lobe other than the diffuse one is drawn.
float SpecularShare(const Material& m, const V3f& o) {
  switch (m.kind) {
    case MaterialKind::kPhong:
      return PhongShare(m);
    case MaterialKind::kConductor:
      return 1;
    case MaterialKind::kPaint:
      return PaintShare(m, o);
    case MaterialKind::kPlastic:
      return PlasticShare(m, CoatAlbedo(m, o.z()));
    case MaterialKind::kFuzz:
      return FuzzShare(m, FuzzAlbedoTable().At(m.alpha_u, o.z()));
    default:
      return 0;
  }
}

V3f SpecularDirection(const Material& m, const V3f& o, float u1, float u2) {
  if (m.kind == MaterialKind::kPhong) return PhongDirection(m, o, u1, u2);
  if (m.kind == MaterialKind::kFuzz) return HemisphereDirection(u1, u2);
  const float av = m.kind == MaterialKind::kPaint ? AlphaU(m) : AlphaV(m);
  const V3f h = SampleGgxNormal(o, AlphaU(m), av, u1, u2);
  return UnitVector(2 * o.dot(h) * h - o);
}

void RequireRange(float value, float low, float high, const char* what, const std::string& where) {
  if (!(value >= low && value <= high)) {
    throw Error(where + ": material " + what + " is " + std::to_string(value) +
                "; give a number from " + std::to_string(low) + " to " + std::to_string(high));
  }
}

}  // namespace

BsdfValue EvaluateBsdf(const Material& material, const V3f& o, const V3f& i) {
  if (material.kind == MaterialKind::kGlass) return EvaluateGlass(material, o, i);
  if (!(o.z() > 0) || !(i.z() > 0)) return {};
  switch (material.kind) {
    case MaterialKind::kLambert:
      return EvaluateLambert(material.diffuse, i);
    case MaterialKind::kPhong:
      return EvaluatePhong(material, o, i);
    case MaterialKind::kConductor:
      return EvaluateConductor(material, o, i);
    case MaterialKind::kPaint:
      return EvaluatePaint(material, o, i);
    case MaterialKind::kPlastic:
      return EvaluatePlastic(material, o, i);
    case MaterialKind::kFuzz:
      return EvaluateFuzz(material, o, i);
    case MaterialKind::kGlass:
      break;
  }
  return {};
}

BsdfSample SampleBsdf(const Material& material, const V3f& o, float u_lobe, float u1, float u2) {
  if (material.kind == MaterialKind::kGlass) return SampleGlass(material, o, u_lobe, u1, u2);
  if (!(o.z() > 0)) return {};
  BsdfSample sample;
  if (material.kind == MaterialKind::kLambert) {
    sample.direction = CosineDirection(u1, u2);
    sample.density = sample.direction.z() * kInversePi;
    sample.weight = material.diffuse;
    return sample;
  }
  const float share = SpecularShare(material, o);
  if (u_lobe < share) {
    if (material.kind == MaterialKind::kConductor && SmoothCoat(material)) {
      return MirrorSample(o, SchlickColor(material.specular, o.z()));
    }
    if (material.kind == MaterialKind::kPlastic && SmoothCoat(material)) {
      return MirrorSample(o, V3f::Constant(DielectricFresnel(o.z(), material.ior) / share));
    }
    sample.direction = SpecularDirection(material, o, u1, u2);
  } else {
    sample.direction = CosineDirection(u1, u2);
  }
  if (!(sample.direction.z() > 0)) return {};
  const BsdfValue value = EvaluateBsdf(material, o, sample.direction);
  if (!(value.density > 0)) return {};
  sample.density = value.density;
  sample.weight = (1 / value.density) * value.value;
  return sample;
}

bool IsDelta(const Material& material) {
  return material.kind == MaterialKind::kGlass       ? GlassIsClear(material)
         : material.kind == MaterialKind::kConductor ? SmoothCoat(material)
                                                     : false;
}

void ValidateMaterial(const Material& material, const std::string& where) {
  for (int c = 0; c < 3; ++c) {
    RequireRange(material.diffuse[c], 0, 1, "diffuse", where);
    RequireRange(material.specular[c], 0, 1, "specular", where);
    RequireRange(material.absorption_per_mm[c], 0, 1e6f, "absorption", where);
  }
  RequireRange(material.exponent, 0, 1e7f, "exponent", where);
  RequireRange(material.alpha_u, 0, 1, "roughness", where);
  RequireRange(material.alpha_v, 0, 1, "roughness", where);
  RequireRange(material.ior, 0.2f, 5, "index", where);
}

}  // namespace lfm
