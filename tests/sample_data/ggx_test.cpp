// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/ggx.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "sample_data/random.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

V3 Direction(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

// Integral over the upper hemisphere by the midpoint rule in (theta, phi).
double IntegrateHemisphere(const std::function<double(const V3&)>& f, int steps = 600) {
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double theta = (i + 0.5) / steps * kPi / 2;
    for (int j = 0; j < 2 * steps; ++j) {
      sum += f(Direction(theta, (j + 0.5) / steps * kPi)) * std::sin(theta);
    }
  }
  return sum * (kPi / 2 / steps) * (kPi / steps);
}

TEST(Ggx, DistributionProjectsToUnitArea) {
  for (double alpha : {0.2, 0.35, 0.8, 1.0}) {
    const double area =
        IntegrateHemisphere([&](const V3& h) { return GgxDistribution(h.z(), alpha) * h.z(); });
    EXPECT_NEAR(area, 1, 2e-3) << alpha;
  }
}

// Heitz 2014, section 3.3: with masking of the view alone, F = 1 reflects exactly everything.
TEST(Ggx, WeakWhiteFurnaceIsOne) {
  for (double alpha : {0.2, 0.35, 0.6}) {
    for (double theta : {0.1, 0.7, 1.2, 1.45}) {
      const V3 v = Direction(theta, 0.4);
      // Over half vectors, so that reflections below the horizon are counted as well:
      // dl = 4 (v.h) dh.
      const double reflected = IntegrateHemisphere([&](const V3& h) {
        const double vh = v.dot(h);
        return vh > 0 ? GgxMasking(v.z(), alpha) * GgxDistribution(h.z(), alpha) * vh / v.z() : 0.0;
      });
      EXPECT_NEAR(reflected, 1, 4e-3) << alpha << " " << theta;
    }
  }
}

TEST(Ggx, NeverReflectsMoreThanArrives) {
  for (double alpha : {0.2, 0.27, 0.35}) {
    for (double theta : {0.0, 0.6, 1.2, 1.5}) {
      const V3 v = Direction(theta, 0);
      const double albedo =
          IntegrateHemisphere([&](const V3& l) { return GgxReflection(v, l, alpha) * l.z(); });
      EXPECT_LE(albedo, 1.002) << alpha << " " << theta;
      EXPECT_GT(albedo, 0.7) << alpha << " " << theta;
    }
  }
}

TEST(Ggx, IsReciprocal) {
  RandomStream random(3, 0, 0);
  for (int i = 0; i < 200; ++i) {
    const V3 v = Direction(random.Uniform(0, 1.5), random.Uniform(0, 6));
    const V3 l = Direction(random.Uniform(0, 1.5), random.Uniform(0, 6));
    const double forward = GgxReflection(v, l, 0.25), backward = GgxReflection(l, v, 0.25);
    EXPECT_NEAR(forward, backward, 1e-12 * (1 + forward));
    EXPECT_GT(forward, 0);
  }
}

TEST(Ggx, IsZeroBelowTheHorizonAndNeverNan) {
  EXPECT_EQ(GgxReflection({0, 0, 1}, {0, 0.8, -0.6}, 0.3), 0);
  EXPECT_EQ(GgxReflection({1, 0, 0}, {0, 0, 1}, 0.3), 0);
  EXPECT_EQ(GgxDistribution(0, 0.3), 0);
  EXPECT_EQ(GgxMasking(-0.1, 0.3), 0);
  EXPECT_TRUE(std::isfinite(GgxReflection(Direction(1.5707, 0), Direction(1.5707, 3.1), 0.2)));
}

TEST(Ggx, FresnelMeetsItsEnds) {
  EXPECT_DOUBLE_EQ(SchlickFresnel(0.3, 1), 0.3);
  EXPECT_DOUBLE_EQ(SchlickFresnel(0.3, 0), 1);
  EXPECT_DOUBLE_EQ(SchlickFresnel(0.3, 1.5), 0.3);
}

// Counts of sampled reflections in bins of (theta, phi) against the density integrated over them.
TEST(Ggx, SamplerFollowsItsDensity) {
  constexpr int kThetaBins = 10, kPhiBins = 12, kSamples = 60000;
  for (double theta : {0.2, 1.0}) {
    const V3 v = Direction(theta, 0.7);
    const double alpha = 0.35;
    std::vector<double> expected(kThetaBins * kPhiBins + 1, 0), counts(expected.size(), 0);
    const auto bin = [&](const V3& l) -> size_t {
      if (l.z() <= 0) return expected.size() - 1;
      const double t = std::acos(std::min(1.0, l.z())) / (kPi / 2);
      double phi = std::atan2(l.y(), l.x());
      if (phi < 0) phi += 2 * kPi;
      const int i = std::min(kThetaBins - 1, static_cast<int>(t * kThetaBins));
      const int j = std::min(kPhiBins - 1, static_cast<int>(phi / (2 * kPi) * kPhiBins));
      return static_cast<size_t>(i) * kPhiBins + j;
    };
    double inside = 0;
    IntegrateHemisphere([&](const V3& l) {
      const double density = VisibleNormalReflectionDensity(v, l, alpha);
      const double weight = density * std::sqrt(1 - l.z() * l.z()) * (kPi / 2 / 600) * (kPi / 600);
      expected[bin(l)] += weight * kSamples;
      inside += weight;
      return 0.0;
    });
    expected.back() = (1 - inside) * kSamples;
    RandomStream random(11, 0, 0);
    for (int s = 0; s < kSamples; ++s) {
      const double u1 = random.Uniform(), u2 = random.Uniform();
      const V3 h = SampleVisibleNormal(v, alpha, u1, u2);
      counts[bin(2 * v.dot(h) * h - v)] += 1;
    }
    double chi2 = 0;
    int degrees = -1;
    double rest_expected = 0, rest_counted = 0;
    for (size_t b = 0; b < expected.size(); ++b) {
      if (expected[b] < 8) {
        rest_expected += expected[b];
        rest_counted += counts[b];
        continue;
      }
      chi2 += std::pow(counts[b] - expected[b], 2) / expected[b];
      ++degrees;
    }
    if (rest_expected > 8) {
      chi2 += std::pow(rest_counted - rest_expected, 2) / rest_expected;
      ++degrees;
    }
    ASSERT_GT(degrees, 20);
    // Four standard deviations of the chi-square distribution.
    EXPECT_LT(chi2, degrees + 4 * std::sqrt(2.0 * degrees)) << theta;
  }
}

TEST(CoatLobe, AgreesWithTheIntegralOfTheBrdf) {
  for (double cos_v : {0.95, 0.5, 0.2}) {
    for (double f0 : {0.1, 0.4}) {
      const V3 v(std::sqrt(1 - cos_v * cos_v), 0, cos_v);
      const double albedo = IntegrateHemisphere([&](const V3& l) {
        const V3 h = (v + l).normalized();
        return SchlickFresnel(f0, v.dot(h)) * GgxReflection(v, l, 0.3) * l.z();
      });
      const CoatLobe lobe = IntegrateCoatLobe(cos_v, 0.3);
      EXPECT_NEAR(lobe.scale * f0 + lobe.bias, albedo, 3e-3) << cos_v << " " << f0;
      EXPECT_NEAR(lobe.zonal[0], 1, 1e-12);
      EXPECT_GT(lobe.zonal[1], lobe.zonal[2]);
    }
  }
}

TEST(CoatLobe, TableInterpolatesWithinOnePercent) {
  const CoatLobeTable table;
  for (double cos_v : {0.31, 0.62, 0.97}) {
    for (double alpha : {0.21, 0.33}) {
      const CoatLobe a = table.Lookup(cos_v, alpha), b = IntegrateCoatLobe(cos_v, alpha);
      EXPECT_NEAR(a.scale, b.scale, 0.01);
      EXPECT_NEAR(a.bias, b.bias, 0.01);
      EXPECT_NEAR(a.zonal[2], b.zonal[2], 0.01);
    }
  }
}

}  // namespace
}  // namespace lfm
