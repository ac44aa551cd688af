// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/bsdf.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/error.h"
#include "sample_data/ggx.h"
#include "sample_data/lanes/lane_convert.h"
#include "sample_data/lanes/microfacet.h"
#include "sample_data/layer_albedo.h"
#include "sample_data/random.h"
#include "tests/sample_data/chi_square.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr double kPi = std::numbers::pi;

V3f Direction(double theta, double phi) {
  return V3f(static_cast<float>(std::sin(theta) * std::cos(phi)),
             static_cast<float>(std::sin(theta) * std::sin(phi)),
             static_cast<float>(std::cos(theta)));
}

Material Make(MaterialKind kind, float diffuse, float specular, float au, float av) {
  Material m;
  m.kind = kind;
  m.diffuse = V3f::Constant(diffuse);
  m.specular = V3f::Constant(specular);
  m.alpha_u = au;
  m.alpha_v = av;
  return m;
}

Material MakePhong(float diffuse, float specular, float exponent) {
  Material m = Make(MaterialKind::kPhong, diffuse, specular, 0, 0);
  m.exponent = exponent;
  return m;
}

// Mean of the sampled weights, radiance in glass scaled back: the share of a white furnace's light
// that comes back, and its standard error.
struct Albedo {
  double mean, error;
};
Albedo SampledAlbedo(const Material& m, const V3f& o, int samples, uint64_t seed) {
  RandomStream random(seed, 0, 0);
  double sum = 0, squares = 0;
  for (int s = 0; s < samples; ++s) {
    const float a = static_cast<float>(random.Bits() >> 40) * 0x1p-24f;
    const float b = static_cast<float>(random.Bits() >> 40) * 0x1p-24f;
    const float c = static_cast<float>(random.Bits() >> 40) * 0x1p-24f;
    const BsdfSample sample = SampleBsdf(m, o, a, b, c);
    const double w = sample.weight.x() * sample.index_ratio2;
    EXPECT_TRUE(std::isfinite(w));
    sum += w;
    squares += w * w;
  }
  const double mean = sum / samples;
  return {mean, std::sqrt(std::max(0.0, squares / samples - mean * mean) / samples)};
}

// The same from EvaluateBsdf alone, over the sphere.
double IntegratedAlbedo(const Material& m, const V3f& o, int steps = 400) {
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double theta = (i + 0.5) / steps * kPi;
    for (int j = 0; j < steps; ++j) {
      const V3f d = Direction(theta, (j + 0.5) / steps * 2 * kPi);
      const bool crossed = m.kind == MaterialKind::kGlass && d.z() * o.z() < 0;
      const double scale = !crossed ? 1 : std::pow(m.ior, o.z() > 0 ? 2 : -2);
      sum += EvaluateBsdf(m, o, d).value.x() * scale * std::sin(theta);
    }
  }
  return sum * (kPi / steps) * (2 * kPi / steps);
}

std::vector<Material> Zoo() {
  std::vector<Material> zoo = {Make(MaterialKind::kLambert, 0.8f, 0, 0, 0),
                               MakePhong(0.3f, 0.6f, 0), MakePhong(0.3f, 0.6f, 40)};
  for (float alpha : {0.15f, 0.4f, 1.0f}) {
    zoo.push_back(Make(MaterialKind::kConductor, 0, 0.9f, alpha, alpha));
    zoo.push_back(Make(MaterialKind::kPaint, 0.4f, 0.3f, alpha, alpha));
    zoo.push_back(Make(MaterialKind::kPlastic, 0.9f, 0, alpha, alpha));
    zoo.push_back(Make(MaterialKind::kGlass, 0, 0, alpha, alpha));
    zoo.push_back(Make(MaterialKind::kFuzz, 0.5f, 0.8f, alpha, alpha));
  }
  zoo.push_back(Make(MaterialKind::kConductor, 0, 0.9f, 0.1f, 0.5f));
  zoo.push_back(Make(MaterialKind::kPlastic, 0.6f, 0, 0.3f, 0.12f));
  return zoo;
}

std::string Name(const Material& m) {
  return "kind " + std::to_string(static_cast<int>(m.kind)) + " alpha " +
         std::to_string(m.alpha_u) + " " + std::to_string(m.alpha_v);
}

TEST(Bsdf, LosslessMaterialsReturnAllLightOfAWhiteFurnace) {
  for (double theta : {0.0, 0.4, 1.0, 1.4}) {
    const V3f o = Direction(theta, 0.7);
    const auto check = [&](const Material& m, double tolerance_abs) {
      EXPECT_NEAR(SampledAlbedo(m, o, 20000, 5).mean, 1, tolerance_abs) << Name(m) << " " << theta;
    };
    check(Make(MaterialKind::kLambert, 1, 0, 0, 0), 1e-6);
    check(Make(MaterialKind::kConductor, 0, 1, 0, 0), 1e-6);
    check(Make(MaterialKind::kGlass, 0, 0, 0, 0), 1e-5);
    // White bases get exactly what the layer leaves; the tables are good to 1 %.
    for (float alpha : {0.0f, 0.1f, 0.35f, 0.8f}) {
      check(Make(MaterialKind::kPlastic, 1, 0, alpha, alpha), 0.012);
    }
    for (float alpha : {0.2f, 0.5f, 1.0f}) check(Make(MaterialKind::kFuzz, 1, 1, alpha, 0), 0.015);
  }
  // From inside, beyond the critical angle too.
  for (double theta : {1.7, 2.4, 3.1}) {
    EXPECT_NEAR(
        SampledAlbedo(Make(MaterialKind::kGlass, 0, 0, 0, 0), Direction(theta, 1), 5000, 5).mean, 1,
        1e-5);
  }
}

TEST(Bsdf, NoMaterialReturnsMoreThanArrives) {
  for (const Material& m : Zoo()) {
    for (double theta : {0.05, 0.8, 1.3, 1.53}) {
      const Albedo a = SampledAlbedo(m, Direction(theta, 0.4), 8000, 9);
      EXPECT_LE(a.mean, 1.01 + 4 * a.error) << Name(m) << " " << theta;
      EXPECT_GT(a.mean, 0.2) << Name(m) << " " << theta;
    }
  }
}

// Light scattered twice between facets is lost: 6 % at alpha 0.2, 70 % at alpha 1.
TEST(Bsdf, SingleScatteringLossOfMicrofacetsIsBounded) {
  for (const auto& [alpha, least] :
       {std::pair{0.05f, 0.985}, {0.2f, 0.90}, {0.5f, 0.66}, {1.0f, 0.29}}) {
    for (double theta : {0.0, 0.9}) {
      const V3f o = Direction(theta, 0.3);
      const double metal =
          SampledAlbedo(Make(MaterialKind::kConductor, 0, 1, alpha, alpha), o, 20000, 2).mean;
      EXPECT_GE(metal, least) << alpha << " " << theta;
      EXPECT_LE(metal, 1 + 1e-5);
      const double glass =
          SampledAlbedo(Make(MaterialKind::kGlass, 0, 0, alpha, alpha), o, 20000, 2).mean;
      EXPECT_GE(glass, least) << alpha << " " << theta;
    }
  }
}

TEST(Bsdf, SampledWeightsAgreeWithTheIntegralOfTheBsdf) {
  for (const Material& m : Zoo()) {
    for (double theta : {0.3, 1.1}) {
      const V3f o = Direction(theta, 0.4);
      const Albedo a = SampledAlbedo(m, o, 20000, 3);
      EXPECT_NEAR(a.mean, IntegratedAlbedo(m, o), 0.006 + 4 * a.error) << Name(m) << " " << theta;
    }
  }
  const Material glass = Make(MaterialKind::kGlass, 0, 0, 0.3f, 0.3f);
  const Albedo inside = SampledAlbedo(glass, Direction(2.7, 1), 20000, 3);
  EXPECT_NEAR(inside.mean, IntegratedAlbedo(glass, Direction(2.7, 1)), 0.006 + 4 * inside.error);
}

TEST(Bsdf, IsReciprocal) {
  RandomStream random(4, 0, 0);
  for (const Material& m : Zoo()) {
    const bool glass = m.kind == MaterialKind::kGlass;
    for (int k = 0; k < 60; ++k) {
      const V3f o = Direction(random.Uniform(0.05, 1.5), random.Uniform(0, 6));
      V3f i = Direction(random.Uniform(0.05, 1.5), random.Uniform(0, 6));
      if (glass && k % 2 == 1) i.z() = -i.z();
      // f / n_o^2 is symmetric (Walter et al. 2007 with radiance that scales by the index).
      const double no2 = 1, ni2 = i.z() < 0 ? m.ior * m.ior : 1;
      const double forth = EvaluateBsdf(m, o, i).value.x() / std::abs(i.z()) / no2;
      const double back = EvaluateBsdf(m, i, o).value.x() / std::abs(o.z()) / ni2;
      EXPECT_NEAR(forth, back, 2e-3 * (forth + back) + 1e-6) << Name(m);
    }
  }
}

// Counts of drawn directions in bins of (cosine, azimuth) against the stated density.
void CheckSampler(const Material& m, const V3f& o, uint64_t seed) {
  constexpr int kRows = 24, kColumns = 16, kFine = 16, kSamples = 40000;
  std::vector<double> counts(kRows * kColumns + 1, 0), expected(counts.size(), 0);
  double inside = 0;
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) {
      double sum = 0;
      for (int f = 0; f < kFine * kFine; ++f) {
        const double theta = (r + (f / kFine + 0.5) / kFine) / kRows * kPi;
        const double phi = (c + (f % kFine + 0.5) / kFine) / kColumns * 2 * kPi;
        sum += EvaluateBsdf(m, o, Direction(theta, phi)).density * std::sin(theta);
      }
      const double p = sum / (kFine * kFine) * (kPi / kRows) * (2 * kPi / kColumns);
      expected[static_cast<size_t>(r) * kColumns + c] = p * kSamples;
      inside += p;
    }
  }
  ASSERT_LE(inside, 1.003) << Name(m);
  expected.back() = std::max(0.0, 1 - inside) * kSamples;
  RandomStream random(seed, 1, 0);
  for (int s = 0; s < kSamples; ++s) {
    const float a = static_cast<float>(random.Bits() >> 40) * 0x1p-24f;
    const float b = static_cast<float>(random.Bits() >> 40) * 0x1p-24f;
    const float c = static_cast<float>(random.Bits() >> 40) * 0x1p-24f;
    const BsdfSample sample = SampleBsdf(m, o, a, b, c);
    size_t bin = counts.size() - 1;
    if (sample.density > 0) {
      const V3f& d = sample.direction;
      const double theta = std::atan2(std::hypot(d.x(), d.y()), d.z());
      double phi = std::atan2(d.y(), d.x());
      if (phi < 0) phi += 2 * kPi;
      bin = static_cast<size_t>(std::min(kRows - 1, static_cast<int>(theta / kPi * kRows))) *
                kColumns +
            std::min(kColumns - 1, static_cast<int>(phi / (2 * kPi) * kColumns));
    }
    counts[bin] += 1;
  }
  EXPECT_GT(ChiSquareTest(counts, expected), kSignificance) << Name(m) << " oz " << o.z();
}

TEST(Bsdf, SamplersFollowTheirDensities) {
  uint64_t seed = 1;
  for (const Material& m : Zoo()) {
    CheckSampler(m, Direction(0.35, 0.6), seed++);
    CheckSampler(m, Direction(1.15, 2.6), seed++);
    if (m.kind == MaterialKind::kGlass) CheckSampler(m, Direction(2.75, 0.6), seed++);
  }
}

TEST(Bsdf, ChiSquareTailIsThatOfTheTables) {
  EXPECT_NEAR(ChiSquareTail(3.841, 1), 0.05, 1e-4);
  EXPECT_NEAR(ChiSquareTail(18.307, 10), 0.05, 1e-4);
  EXPECT_NEAR(ChiSquareTail(149.449, 100), 0.001, 1e-5);
  // And the test sees a sampler that is 10 % off in half of its bins.
  std::vector<double> counts, expected;
  for (int b = 0; b < 100; ++b) {
    counts.push_back(b % 2 == 0 ? 440 : 360);
    expected.push_back(400);
  }
  EXPECT_LT(ChiSquareTest(counts, expected), kSignificance);
}

// integral of (r.i)+ (n.i)+ = 2/3 (sin t + (pi - t) cos t), t the angle between r and n.
TEST(Bsdf, PhongAlbedoHasItsClosedForm) {
  for (float exponent : {0.0f, 1.0f, 30.0f, 1e3f, 1e5f}) {
    const Albedo a = SampledAlbedo(MakePhong(0, 1, exponent), Direction(0, 0), 20000, 7);
    EXPECT_NEAR(a.mean, 1, 4 * a.error + 1e-5) << exponent;
  }
  for (double theta : {0.5, 1.0, 1.5}) {
    const double closed = (std::sin(theta) + (kPi - theta) * std::cos(theta)) / kPi;
    EXPECT_NEAR(IntegratedAlbedo(MakePhong(0, 1, 1), Direction(theta, 0)), closed, 1e-3) << theta;
  }
}

// cos^(s + 1) of the angle with the mirror direction is uniform.
TEST(Bsdf, PhongIsSampledExactlyAtExtremeExponents) {
  for (float exponent : {0.0f, 20.0f, 1e5f}) {
    const Material m = MakePhong(0, 1, exponent);
    RandomStream random(8, 0, 0);
    std::vector<double> counts(20, 0), expected(20, 1000);
    for (int s = 0; s < 20000; ++s) {
      const float b = static_cast<float>(random.Bits() >> 40) * 0x1p-24f;
      const float c = static_cast<float>(random.Bits() >> 40) * 0x1p-24f;
      const BsdfSample sample = SampleBsdf(m, {0, 0, 1}, 0, b, c);
      const Eigen::Vector3d d = sample.direction.cast<double>();
      const double missing = 0.5 * (d - Eigen::Vector3d(0, 0, 1)).squaredNorm();
      const double u = std::exp((exponent + 1) * std::log1p(-std::min(missing, 1 - 1e-12)));
      counts[std::min(19, static_cast<int>(u * 20))] += 1;
      const V3f weight = sample.weight;
      EXPECT_NEAR(weight.x(), (exponent + 2) / (exponent + 1) * d.z(), 0.02);
    }
    EXPECT_GT(ChiSquareTest(counts, expected), kSignificance) << exponent;
  }
}

TEST(Bsdf, IsotropicGgxAgreesWithTheStudiosInDoublePrecision) {
  RandomStream random(6, 0, 0);
  for (int k = 0; k < 300; ++k) {
    const double alpha = random.Uniform(0.1, 1);
    const V3f o = Direction(random.Uniform(0, 1.5), random.Uniform(0, 6));
    const V3f i = Direction(random.Uniform(0, 1.5), random.Uniform(0, 6));
    const float a = static_cast<float>(alpha);
    const GgxReflected<float> r = ReflectGgx(ToLane(o), ToLane(i), a, a);
    const double value = GgxReflection(o.cast<double>(), i.cast<double>(), alpha);
    const double density =
        VisibleNormalReflectionDensity(o.cast<double>(), i.cast<double>(), alpha);
    EXPECT_NEAR(r.value, value, 1e-4 * value + 1e-6);
    EXPECT_NEAR(r.density, density, 1e-4 * density + 1e-6);
    EXPECT_NEAR(GgxVisible(ToLane(o), a, a), GgxMasking(o.z(), alpha), 1e-5);
    const double u1 = random.Uniform(), u2 = random.Uniform();
    const Eigen::Vector3d h = SampleVisibleNormal(o.cast<double>(), alpha, u1, u2);
    const V3f mine =
        FromLane(SampleGgxNormal(ToLane(o), a, a, static_cast<float>(u1), static_cast<float>(u2)));
    EXPECT_LT((mine.cast<double>() - h).norm(), 2e-3);
  }
}

// What light_baking gives the base and coat_shading the coat.
TEST(Bsdf, PaintIsTheStudiosPaint) {
  Material m = Make(MaterialKind::kPaint, 0, 0, 0.27f, 0.27f);
  m.diffuse = {0.40f, 0.245f, 0.155f};
  m.specular = {0.36f, 0.28f, 0.20f};
  const V3f o = Direction(0.7, 0.2), i = Direction(0.5, 2.9);
  const V3f h = (o + i).normalized();
  const V3f value = EvaluateBsdf(m, o, i).value;
  for (int c = 0; c < 3; ++c) {
    const double coat = GgxReflection(o.cast<double>(), i.cast<double>(), 0.27) *
                        SchlickFresnel(m.specular[c], o.dot(h));
    const double base = m.diffuse[c] * (1 - m.specular[c]) / kPi;
    EXPECT_NEAR(value[c], (base + coat) * i.z(), 1e-5);
  }
}

TEST(Bsdf, AnisotropyStretchesTheHighlightAcrossTheSmootherAxis) {
  const Material m = Make(MaterialKind::kConductor, 0, 1, 0.08f, 0.4f);
  const V3f o(0, 0, 1);
  EXPECT_GT(EvaluateBsdf(m, o, Direction(0.4, kPi / 2)).value.x(),
            20 * EvaluateBsdf(m, o, Direction(0.4, 0)).value.x());
}

TEST(Bsdf, OpaqueMaterialsAreBlackFromBehindAndNeverNan) {
  for (const Material& m : Zoo()) {
    if (m.kind != MaterialKind::kGlass) {
      EXPECT_TRUE(EvaluateBsdf(m, {0, 0, -1}, {0, 0, 1}).value.isZero());
      EXPECT_TRUE(EvaluateBsdf(m, {0, 0, 1}, {0, 0.6f, -0.8f}).value.isZero());
      EXPECT_TRUE(SampleBsdf(m, {0, 0.6f, -0.8f}, 0.5f, 0.5f, 0.5f).weight.isZero());
    }
    for (const V3f& o : {V3f(1, 0, 1e-7f), V3f(0, 0, 1), V3f(1, 0, 0)}) {
      for (float u : {0.0f, 0.5f, 0.99999994f}) {
        const BsdfSample s = SampleBsdf(m, o, u, u, u);
        EXPECT_TRUE(s.weight.allFinite() && s.direction.allFinite()) << Name(m);
        EXPECT_TRUE(EvaluateBsdf(m, o, s.direction).value.allFinite()) << Name(m);
      }
    }
  }
}

TEST(Bsdf, MaterialsOutOfRangeAreRefusedByName) {
  const auto refused = [](Material m, const std::string& word) {
    try {
      ValidateMaterial(m, "object 'pot'");
    } catch (const Error& error) {
      const std::string text = error.what();
      return text.find(word) != std::string::npos && text.find("pot") != std::string::npos;
    }
    return false;
  };
  ValidateMaterial(Material(), "object 'pot'");
  Material m;
  m.diffuse.y() = 1.5f;
  EXPECT_TRUE(refused(m, "diffuse"));
  m = {};
  m.exponent = -1;
  EXPECT_TRUE(refused(m, "exponent"));
  m = {};
  m.alpha_v = std::nanf("");
  EXPECT_TRUE(refused(m, "roughness"));
  m = {};
  m.ior = 0;
  EXPECT_TRUE(refused(m, "index"));
}

TEST(LayerAlbedo, DielectricTableIsGoodToOnePercent) {
  const DielectricAlbedo& table = DielectricAlbedoTable();
  for (float ior : {1.2f, 1.5f, 2.0f}) {
    for (float alpha : {0.15f, 0.45f, 0.9f}) {
      for (double theta : {0.2, 0.9, 1.35}) {
        Material m = Make(MaterialKind::kPlastic, 0, 0, alpha, alpha);
        m.ior = ior;
        const V3f o = Direction(theta, 0);
        EXPECT_NEAR(table.At(ior, alpha, o.z()), IntegratedAlbedo(m, o), 0.01)
            << ior << " " << alpha << " " << theta;
      }
    }
  }
}

}  // namespace
}  // namespace lfm
