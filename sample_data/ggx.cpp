// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/ggx.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace lfm {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kAlphaSteps = 9, kCosineSteps = 33;
constexpr double kAlphaMin = 0.1, kAlphaMax = 0.5;

// Smith's Lambda of GGX.
double Lambda(double cosine, double alpha) {
  const double cos2 = cosine * cosine;
  const double tan2 = std::max(0.0, 1 - cos2) / cos2;
  return 0.5 * (std::sqrt(1 + alpha * alpha * tan2) - 1);
}

double RadicalInverse(unsigned bits) {
  double result = 0, digit = 0.5;
  for (; bits != 0; bits >>= 1, digit *= 0.5) {
    if (bits & 1u) result += digit;
  }
  return result;
}

CoatLobe Blend(const CoatLobe& a, const CoatLobe& b, double t) {
  const auto mix = [t](double x, double y) { return x + t * (y - x); };
  CoatLobe lobe;
  lobe.scale = mix(a.scale, b.scale);
  lobe.bias = mix(a.bias, b.bias);
  lobe.mean_sin = mix(a.mean_sin, b.mean_sin);
  lobe.mean_cos = mix(a.mean_cos, b.mean_cos);
  for (int band = 0; band < 5; ++band) lobe.zonal[band] = mix(a.zonal[band], b.zonal[band]);
  return lobe;
}

}  // namespace

double GgxDistribution(double cos_h, double alpha) {
  if (!(cos_h > 0)) return 0;
  const double a2 = alpha * alpha;
  const double d = cos_h * cos_h * (a2 - 1) + 1;
  return a2 / (kPi * d * d);
}

double GgxMasking(double cos_v, double alpha) {
  return cos_v > 0 ? 1 / (1 + Lambda(cos_v, alpha)) : 0;
}

double GgxReflection(const Eigen::Vector3d& v, const Eigen::Vector3d& l, double alpha) {
  if (!(v.z() > 0) || !(l.z() > 0)) return 0;
  const Eigen::Vector3d h = (v + l).normalized();
  const double g2 = 1 / (1 + Lambda(v.z(), alpha) + Lambda(l.z(), alpha));
  return GgxDistribution(h.z(), alpha) * g2 / (4 * v.z() * l.z());
}

double SchlickFresnel(double f0, double cos_vh) {
  const double m = 1 - std::clamp(cos_vh, 0.0, 1.0);
  return f0 + (1 - f0) * m * m * m * m * m;
}

Eigen::Vector3d SampleVisibleNormal(const Eigen::Vector3d& v, double alpha, double u1, double u2) {
  const Eigen::Vector3d stretched =
      Eigen::Vector3d(alpha * v.x(), alpha * v.y(), v.z()).normalized();
  const double planar = std::hypot(stretched.x(), stretched.y());
  const Eigen::Vector3d t1 =
      planar > 1e-9 ? Eigen::Vector3d(-stretched.y() / planar, stretched.x() / planar, 0)
                    : Eigen::Vector3d(1, 0, 0);
  const Eigen::Vector3d t2 = stretched.cross(t1);
  const double radius = std::sqrt(u1), angle = 2 * kPi * u2;
  const double p1 = radius * std::cos(angle);
  const double s = 0.5 * (1 + stretched.z());
  const double p2 = (1 - s) * std::sqrt(std::max(0.0, 1 - p1 * p1)) + s * radius * std::sin(angle);
  const Eigen::Vector3d h =
      p1 * t1 + p2 * t2 + std::sqrt(std::max(0.0, 1 - p1 * p1 - p2 * p2)) * stretched;
  return Eigen::Vector3d(alpha * h.x(), alpha * h.y(), std::max(1e-9, h.z())).normalized();
}

double VisibleNormalReflectionDensity(const Eigen::Vector3d& v, const Eigen::Vector3d& l,
                                      double alpha) {
  if (!(v.z() > 0)) return 0;
  const Eigen::Vector3d h = (v + l).normalized();
  if (!(h.z() > 0) || !(v.dot(h) > 0)) return 0;
  return GgxMasking(v.z(), alpha) * GgxDistribution(h.z(), alpha) / (4 * v.z());
}

CoatLobe IntegrateCoatLobe(double cos_v, double alpha) {
  constexpr int kSamples = 4096;
  const double cosine = std::clamp(cos_v, 1e-3, 1.0);
  const Eigen::Vector3d v(std::sqrt(1 - cosine * cosine), 0, cosine);
  struct Sample {
    Eigen::Vector3d direction;
    double weight;
  };
  std::vector<Sample> samples;
  samples.reserve(kSamples);
  CoatLobe lobe;
  double total = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector3d h = SampleVisibleNormal(v, alpha, (i + 0.5) / kSamples,
                                                  RadicalInverse(static_cast<unsigned>(i)));
    const double vh = v.dot(h);
    const Eigen::Vector3d l = 2 * vh * h - v;
    if (l.z() <= 0) continue;
    // f cos / density = F G2 / G1.
    const double weight =
        (1 + Lambda(v.z(), alpha)) / (1 + Lambda(v.z(), alpha) + Lambda(l.z(), alpha));
    const double fresnel = SchlickFresnel(0, vh);
    lobe.scale += weight * (1 - fresnel) / kSamples;
    lobe.bias += weight * fresnel / kSamples;
    total += weight;
    mean += weight * l;
    samples.push_back({l, weight});
  }
  mean.normalize();
  lobe.mean_sin = -mean.x();
  lobe.mean_cos = mean.z();
  double zonal[5] = {0, 0, 0, 0, 0};
  for (const Sample& sample : samples) {
    const double x = sample.direction.dot(mean), x2 = x * x;
    const double legendre[5] = {1, x, 0.5 * (3 * x2 - 1), 0.5 * x * (5 * x2 - 3),
                                0.125 * (35 * x2 * x2 - 30 * x2 + 3)};
    for (int band = 0; band < 5; ++band) zonal[band] += sample.weight * legendre[band];
  }
  for (int band = 0; band < 5; ++band) lobe.zonal[band] = zonal[band] / total;
  return lobe;
}

CoatLobeTable::CoatLobeTable() : lobes_(static_cast<size_t>(kAlphaSteps) * kCosineSteps) {
  for (int a = 0; a < kAlphaSteps; ++a) {
    const double alpha = kAlphaMin + (kAlphaMax - kAlphaMin) * a / (kAlphaSteps - 1);
    for (int c = 0; c < kCosineSteps; ++c) {
      lobes_[static_cast<size_t>(a) * kCosineSteps + c] =
          IntegrateCoatLobe(static_cast<double>(c) / (kCosineSteps - 1), alpha);
    }
  }
}

CoatLobe CoatLobeTable::Lookup(double cos_v, double alpha) const {
  const double a =
      std::clamp((alpha - kAlphaMin) / (kAlphaMax - kAlphaMin), 0.0, 1.0) * (kAlphaSteps - 1);
  const double c = std::clamp(cos_v, 0.0, 1.0) * (kCosineSteps - 1);
  const int a0 = std::min(static_cast<int>(a), kAlphaSteps - 2);
  const int c0 = std::min(static_cast<int>(c), kCosineSteps - 2);
  const CoatLobe* row = &lobes_[static_cast<size_t>(a0) * kCosineSteps + c0];
  return Blend(Blend(row[0], row[1], c - c0),
               Blend(row[kCosineSteps], row[kCosineSteps + 1], c - c0), a - a0);
}

}  // namespace lfm
