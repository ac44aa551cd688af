// SPDX-License-Identifier: BSD-3-Clause
// Mahajan 2007, Section 2.1: Figures 4 and 5 and Equation 12.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/mahajan_report.h"
#include "core/formatted_text.h"
#include "fields/dimension.h"
#include "fields/toeplitz_spectrum.h"

namespace lfm {
namespace {

constexpr double kPi = std::numbers::pi, kShare = 0.999;
constexpr int kFigurePixels = 3000, kPixels = 600;

ChartCurve First(const std::string& name, const std::vector<double>& values, size_t count) {
  ChartCurve curve{name, {}, {}};
  for (size_t i = 0; i < std::min(count, values.size()); ++i) {
    curve.x.push_back(static_cast<double>(i));
    curve.y.push_back(values[i] / static_cast<double>(values.size()));
  }
  return curve;
}

void DrawFigure4(MahajanReport& report) {
  const FlatCovariance g = PhongCovariance(50);
  for (const int part : {2, 4, 8}) {
    const std::vector<double> samples = SampleCovariance(g, kPi / part, kFigurePixels);
    const std::vector<double> eigenvalues = ToeplitzEigenvalues(samples);
    const std::vector<double> fourier = TruncatedFourier(samples);
    const double difference = SummedDifference(eigenvalues, fourier);
    const std::string name = FormattedText("Phong s = 50, p = 3000, beta = pi/%d", part);
    report.Draw(
        FormattedText("figure4_pi_%d", part),
        {"Eigenvalues and Fourier coefficients: " + FormattedText("s = 50, beta = pi/%d", part),
         "index, by size",
         "eigenvalue / p",
         ChartScale::kLinear,
         {First("eigenvalues", eigenvalues, 30), First("Fourier", fourier, 30)}});
    const std::string measured = FormattedText("%.1f %%", 100 * difference);
    if (part == 2) {
      report.Add("Figure 4: summed difference, " + name, measured, "<= 10 %", difference <= 0.1);
    } else {
      report.Note("Figure 4: summed difference, " + name, measured);
    }
  }
  std::vector<ChartCurve> curves;
  for (const double exponent : {50.0, 500.0}) {
    ChartCurve curve{FormattedText("Phong s = %g", exponent), {}, {}};
    const FlatCovariance lobe = PhongCovariance(exponent);
    for (double octave = -5; octave <= 0; octave += 0.5) {
      const double beta = kPi / 2 * std::exp2(octave);
      const std::vector<double> samples = SampleCovariance(lobe, beta, kPixels);
      curve.x.push_back(beta * 180 / kPi);
      curve.y.push_back(100 *
                        SummedDifference(ToeplitzEigenvalues(samples), TruncatedFourier(samples)));
    }
    curves.push_back(std::move(curve));
  }
  report.Draw("figure4_difference",
              {"Summed difference of eigenvalues and Fourier coefficients", "beta, degrees", "%",
               ChartScale::kLogarithmic, curves, ChartScale::kLogarithmic});
}

// A half circle seen from inside, -beta to beta about its bottom, diffuse: light comes in through
// the opening (Figure 5b, red). No Toeplitz matrix, so the transport matrix itself.
FunctionRows ConcaveArc(double beta, int places, int lights) {
  FunctionRows rows = MakeFunctionRows(places, lights);
  for (int i = 0; i < places; ++i) {
    const double at = beta * ((2.0 * i + 1) / places - 1);
    const double x = std::sin(at), z = -std::cos(at);
    for (int j = 0; j < lights; ++j) {
      const double light = kPi * ((j + 0.5) / lights - 0.5);  // from straight up
      const double dx = std::sin(light), dz = std::cos(light);
      const double cosine = -(x * dx + z * dz);
      const double exit_z = z + 2 * cosine * dz;
      if (cosine > 0 && exit_z > 0) rows.Row(i)[j] = static_cast<float>(cosine);
    }
  }
  return rows;
}

template <typename Dimension>
ChartCurve AgainstBeta(const std::string& name, const Dimension& dimension) {
  ChartCurve curve{name, {}, {}};
  for (double octave = -5; octave <= 0; octave += 0.5) {
    const double beta = kPi / 2 * std::exp2(octave);
    curve.x.push_back(beta / kPi);
    curve.y.push_back(dimension(beta));
  }
  return curve;
}

ChartCurve OfCovariance(const std::string& name, const FlatCovariance& g) {
  return AgainstBeta(name, [&](double beta) {
    return DimensionOf(ToeplitzEigenvalues(SampleCovariance(g, beta, kPixels)), kShare);
  });
}

void ReportLine(const ChartCurve& curve, MahajanReport& report) {
  const auto line = FitLine(curve.x, curve.y);
  report.Note("Equation 12, " + curve.name,
              FormattedText("omega = %.1f beta' + %.1f, residual %.1f %%", line->slope,
                            line->offset, 100 * line->relative_residual));
}

void DrawFigure5(MahajanReport& report) {
  std::vector<ChartCurve> lobes;
  for (const double exponent : {50.0, 500.0, 5000.0}) {
    lobes.push_back(
        OfCovariance(FormattedText("Phong s = %g", exponent), PhongCovariance(exponent)));
    const auto fit = FitSlope(lobes.back().x, lobes.back().y);
    const std::string what = "Figure 5a: 2D " + lobes.back().name + ", 99.9 %";
    if (exponent < 500) {
      report.Note(what, SlopeText(fit));
    } else {
      report.AddSlope(what, fit, 0.9, 9);
    }
    ReportLine(lobes.back(), report);
  }
  report.Draw("figure5a",
              {"2D Phong: dimensionality against size, 99.9 % of the energy", "beta / pi", "terms",
               ChartScale::kLogarithmic, lobes, ChartScale::kLogarithmic});
  std::vector<ChartCurve> shadows = {
      OfCovariance("step", StepCovariance()), AgainstBeta("concave arc, diffuse", [](double beta) {
        return DimensionOf(ConcaveArc(beta, kPixels, 2048).View(), kShare);
      })};
  report.AddSlope("Figure 5b: 2D step shadow, 99.9 %", FitSlope(shadows[0].x, shadows[0].y), 0.9,
                  1.1);
  report.Note("Figure 5b: 2D concave arc, diffuse, 99.9 %",
              SlopeText(FitSlope(shadows[1].x, shadows[1].y)));
  ReportLine(shadows[0], report);
  report.Draw("figure5b",
              {"2D shadows: dimensionality against size, 99.9 % of the energy", "beta / pi",
               "terms", ChartScale::kLogarithmic, shadows, ChartScale::kLogarithmic});
}

}  // namespace

void DrawFlatland(MahajanReport& report) {
  DrawFigure4(report);
  DrawFigure5(report);
}

}  // namespace lfm
