// SPDX-License-Identifier: BSD-3-Clause
#include "fields/light_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/error.h"
#include "core/image.h"
#include "core/parallel.h"
#include "fields/luminance_fit.h"
#include "fields/quantized_fit.h"

namespace lfm {
namespace {

std::vector<Eigen::Vector3d> Dome(int count) {
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (i + 0.5) / count, r = std::sqrt(1 - z * z);
    directions.emplace_back(r * std::cos(2.4 * i), r * std::sin(2.4 * i), z);
  }
  return directions;
}

// Rows that are sums of basis functions with random coefficients, plus `pedestal`.
FunctionRows RowsOf(LightBasis basis, const FunctionRows& coefficients,
                    const std::vector<Eigen::Vector3d>& lights) {
  FunctionRows rows = MakeFunctionRows(coefficients.rows, static_cast<int>(lights.size()));
  for (size_t j = 0; j < lights.size(); ++j) {
    const Eigen::VectorXd values = LightBasisValues(basis, lights[j]);
    for (int64_t r = 0; r < rows.rows; ++r) {
      double sum = 0;
      for (int t = 0; t < values.size(); ++t) sum += values[t] * coefficients.Row(r)[t];
      rows.Row(r)[j] = static_cast<float>(sum);
    }
  }
  return rows;
}

FunctionRows RandomCoefficients(LightBasis basis, int64_t rows, float scale) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(-1, 1);
  FunctionRows coefficients = MakeFunctionRows(rows, LightBasisTerms(basis));
  for (int64_t r = 0; r < rows; ++r) {
    for (int t = 0; t < coefficients.columns; ++t) coefficients.Row(r)[t] = scale * uniform(random);
  }
  return coefficients;
}

TEST(LightFit, GivesBackTheCoefficientsOfAnyMagnitude) {
  const std::vector<Eigen::Vector3d> lights = Dome(30);
  for (LightBasis basis : {LightBasis::kPolynomial, LightBasis::kHarmonics16}) {
    for (float scale : {1.0f, 1e-25f, 1e25f}) {
      const FunctionRows truth = RandomCoefficients(basis, 5, scale);
      const LightFit fit =
          FitLights(RowsOf(basis, truth, lights).View(), lights, {}, basis, FitSpace::kLinear);
      for (int64_t r = 0; r < 5; ++r) {
        for (int t = 0; t < truth.columns; ++t) {
          EXPECT_NEAR(fit.coefficients.Row(r)[t] / scale, truth.Row(r)[t] / scale, 2e-5);
        }
      }
    }
  }
}

TEST(LightFit, OfSeveralBasesIsThatOfEach) {
  const std::vector<Eigen::Vector3d> lights = Dome(30);
  const FunctionRows rows = RowsOf(LightBasis::kHarmonics16,
                                   RandomCoefficients(LightBasis::kHarmonics16, 700, 1), lights);
  const std::vector<LightBasis> bases = {LightBasis::kPolynomial, LightBasis::kHarmonics9};
  const std::vector<LightFit> together =
      FitLights(rows.View(), lights, {}, bases, FitSpace::kLinear);
  for (size_t i = 0; i < bases.size(); ++i) {
    const LightFit alone = FitLights(rows.View(), lights, {}, bases[i], FitSpace::kLinear);
    for (size_t v = 0; v < alone.coefficients.values.size(); ++v) {
      EXPECT_NEAR(together[i].coefficients.values[v], alone.coefficients.values[v], 1e-6);
    }
  }
}

TEST(LightFit, DoesNotDependOnThreads) {
  const std::vector<Eigen::Vector3d> lights = Dome(30);
  const FunctionRows rows =
      RowsOf(LightBasis::kPolynomial, RandomCoefficients(LightBasis::kPolynomial, 3000, 1), lights);
  const auto fit = [&](int threads) {
    SetThreadCount(threads);
    return FitLights(rows.View(), lights, {}, LightBasis::kHarmonics9, FitSpace::kDisplay)
        .coefficients.values;
  };
  EXPECT_EQ(fit(1), fit(2));
  SetThreadCount(0);
}

TEST(LightFit, LambertianPointIsAlmostExactWithHarmonics) {
  // n . l with n = (0.2, 0.1, ...) has no shadow within 60 degrees of the pole.
  const Eigen::Vector3d normal = Eigen::Vector3d(0.2, 0.1, 1).normalized();
  std::vector<Eigen::Vector3d> lights;
  for (const Eigen::Vector3d& d : Dome(60)) {
    if (d.z() > 0.5) lights.push_back(d);
  }
  FunctionRows rows = MakeFunctionRows(1, static_cast<int>(lights.size()));
  for (size_t j = 0; j < lights.size(); ++j) {
    rows.Row(0)[j] = static_cast<float>(normal.dot(lights[j]));
  }
  const LightFit fit =
      FitLights(rows.View(), lights, {}, LightBasis::kPolynomial, FitSpace::kLinear);
  const Eigen::Vector3d between = Eigen::Vector3d(-0.3, 0.25, 0.9).normalized();
  EXPECT_NEAR(EvaluateFit(fit, between)[0], normal.dot(between), 0.01);
}

TEST(LightFit, DisplaySpaceFitsWhatTheScreenShows) {
  const std::vector<Eigen::Vector3d> lights = Dome(30);
  FunctionRows coded = MakeFunctionRows(1, 30), linear = MakeFunctionRows(1, 30);
  for (int j = 0; j < 30; ++j) {
    coded.Row(0)[j] = static_cast<float>(0.5 + 0.3 * lights[j].x());
    linear.Row(0)[j] = LinearFromSrgb(coded.Row(0)[j]);
  }
  const LightFit fit =
      FitLights(linear.View(), lights, {}, LightBasis::kPolynomial, FitSpace::kDisplay);
  EXPECT_NEAR(fit.coefficients.Row(0)[5], 0.5, 1e-5);
  EXPECT_NEAR(fit.coefficients.Row(0)[3], 0.3, 1e-5);
  EXPECT_NEAR(EvaluateFit(fit, lights[4])[0], linear.Row(0)[4], 1e-5);
}

TEST(LightFit, OneLightIsItsPictureUnderAnyOther) {
  FunctionRows rows = MakeFunctionRows(2, 1);
  rows.Row(0)[0] = 0.7f;
  const LightFit fit =
      FitLights(rows.View(), {{0, 0.6, 0.8}}, {}, LightBasis::kHarmonics16, FitSpace::kLinear);
  for (const Eigen::Vector3d& light :
       {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(NAN, 0, 0)}) {
    EXPECT_NEAR(EvaluateFit(fit, light)[0], 0.7, 1e-6);
    EXPECT_EQ(EvaluateFit(fit, light)[1], 0);
  }
}

TEST(LightFit, LightTwiceCountsAsTheMean) {
  FunctionRows rows = MakeFunctionRows(1, 2);
  rows.Row(0)[0] = 0.2f;
  rows.Row(0)[1] = 0.4f;
  const std::vector<Eigen::Vector3d> twice = {{0, 0, 1}, {0, 0, 1}};
  const LightFit fit =
      FitLights(rows.View(), twice, {}, LightBasis::kPolynomial, FitSpace::kLinear);
  EXPECT_NEAR(EvaluateFit(fit, {0, 0, 1})[0], 0.3, 1e-6);
}

TEST(LightFit, NeverBelowZeroAndNeverNan) {
  FunctionRows rows = MakeFunctionRows(1, 30);
  const std::vector<Eigen::Vector3d> lights = Dome(30);
  for (int j = 0; j < 30; ++j) rows.Row(0)[j] = lights[j].x() > 0.9 ? 1e30f : 0;
  for (FitSpace space : {FitSpace::kLinear, FitSpace::kDisplay}) {
    const LightFit fit = FitLights(rows.View(), lights, {}, LightBasis::kHarmonics16, space);
    for (const Eigen::Vector3d& light : Dome(200)) {
      const float value = EvaluateFit(fit, light)[0];
      EXPECT_TRUE(std::isfinite(value));
      EXPECT_GE(value, 0);
    }
  }
}

TEST(LightFit, RefusesWhatDoesNotFit) {
  FunctionRows rows = MakeFunctionRows(1, 2);
  EXPECT_THROW(FitLights(rows.View(), {{0, 0, 1}}, {}, LightBasis::kPolynomial, FitSpace::kLinear),
               Error);
  rows.Row(0)[1] = std::numeric_limits<float>::infinity();
  EXPECT_THROW(FitLights(rows.View(), {{0, 0, 1}, {1, 0, 0}}, {}, LightBasis::kPolynomial,
                         FitSpace::kLinear),
               Error);
}

// A field of points whose colour is constant.
Field ColoredField(const std::vector<Eigen::Vector3d>& lights) {
  Field field;
  field.points = 2;  // the second is black
  field.channels = 3;
  field.width = 2;
  field.height = 1;
  field.directions = lights;
  field.functions = MakeFunctionRows(6, static_cast<int>(lights.size()));
  const float color[3] = {0.1f, 0.4f, 0.2f};
  for (int c = 0; c < 3; ++c) {
    for (size_t j = 0; j < lights.size(); ++j) {
      field.functions.Row(field.RowOf(0, c))[j] =
          color[c] * static_cast<float>(1 + lights[j].x() * lights[j].y());
    }
  }
  return field;
}

TEST(LuminanceFit, KeepsAColourThatDoesNotChange) {
  const Field field = ColoredField(Dome(30));
  const LuminanceFit fit = FitLuminance(field, {}, LightBasis::kPolynomial, FitSpace::kLinear);
  EXPECT_NEAR(fit.chroma[0], 0.25, 1e-5);
  EXPECT_NEAR(fit.chroma[1], 1, 1e-6);
  EXPECT_NEAR(fit.chroma[2], 0.5, 1e-5);
  EXPECT_EQ(fit.chroma[3], 0);
  const std::vector<float> shown = EvaluateLuminanceFit(fit, 3, field.directions[3]);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(shown[field.RowOf(0, c)], field.functions.Row(field.RowOf(0, c))[3], 1e-5);
    EXPECT_EQ(shown[field.RowOf(1, c)], 0);
  }
}

TEST(QuantizedFit, ComesBackToHalfAStep) {
  const std::vector<Eigen::Vector3d> lights = Dome(30);
  LightFit fit{LightBasis::kHarmonics9,
               FitSpace::kLinear,
               {},
               RandomCoefficients(LightBasis::kHarmonics9, 300, 3)};
  for (int64_t r = 0; r < 300; ++r) {
    fit.coefficients.Row(r)[1] = -2.5f;  // does not vary
    fit.coefficients.Row(r)[2] = 0;
    fit.coefficients.Row(r)[3] += 1000;  // far from zero
  }
  const QuantizedFit quantized = QuantizeFit(fit, 3);
  EXPECT_EQ(quantized.Bytes(), 300 * 9 + 9 * 8);
  EXPECT_EQ(quantized.points, 100);
  const LightFit back = DequantizeFit(quantized);
  for (int t = 0; t < 9; ++t) {
    EXPECT_EQ(quantized.bias[t], std::round(quantized.bias[t]));
    const double tolerance_abs = t == 1 || t == 2 ? 1e-9 : 0.5001 * quantized.step[t] + 1e-4;
    if (t > 3) {
      EXPECT_LE(quantized.step[t], 6.0 / 254);
    }
    for (int64_t r = 0; r < 300; ++r) {
      EXPECT_NEAR(back.coefficients.Row(r)[t], fit.coefficients.Row(r)[t], tolerance_abs) << t;
    }
  }
  EXPECT_THROW(QuantizeFit(fit, 7), Error);
}

TEST(QuantizedFit, ShowsWhatTheFitShows) {
  const Field field = ColoredField(Dome(30));
  const Eigen::Vector3d light = field.directions[5];
  for (FitSpace space : {FitSpace::kLinear, FitSpace::kDisplay}) {
    const LuminanceFit fit = FitLuminance(field, {}, LightBasis::kPolynomial, space);
    const std::vector<float> exact = EvaluateLuminanceFit(fit, 3, light);
    const std::vector<float> stored = EvaluateQuantizedFit(QuantizeFit(fit), 3, light);
    for (size_t i = 0; i < exact.size(); ++i) EXPECT_NEAR(stored[i], exact[i], 0.01);
  }
}

}  // namespace
}  // namespace lfm
