// SPDX-License-Identifier: BSD-3-Clause
// Mahajan 2007, Section 2.2 and Figures 6 and 7a: caps of the sphere of mirrored directions.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/mahajan_report.h"
#include "core/formatted_text.h"
#include "fields/dimension.h"
#include "fields/toeplitz_spectrum.h"
#include "fields/zonal_harmonics.h"

namespace lfm {
namespace {

constexpr double kPi = std::numbers::pi, kShare = 0.9995;

// Far enough for the lobe's spectrum to have ended.
int Degrees(double exponent) { return static_cast<int>(30 + 12 * std::sqrt(exponent)); }

std::vector<double> Normalized(std::vector<double> values) {
  double sum = 0;
  for (const double value : values) sum += value;
  for (double& value : values) value /= sum;
  return values;
}

ChartCurve First(const std::string& name, const std::vector<double>& values, size_t count) {
  ChartCurve curve{name, {}, {}};
  for (size_t i = 0; i < std::min(count, values.size()); ++i) {
    curve.x.push_back(static_cast<double>(i));
    curve.y.push_back(values[i]);
  }
  return curve;
}

// Both sides scaled to a sum of 1: the stretch changes the scale. Order 0 against the coefficients
// once each (the paper: only m = 0 matters), and all against 2 l + 1 copies, where a stretch that
// keeps the cap's area, pi sin(beta / 2), is the one that counts right.
void DrawFigure6(MahajanReport& report) {
  const std::vector<double> f = PhongZonalCoefficients(100, Degrees(100));
  const std::vector<double> g = SquaredCoefficients(f);
  for (const int part : {2, 4}) {
    const double beta = kPi / part;
    const int degrees = 4 * part * 20;
    const auto stretched = Normalized(ScaledCoefficients(g, beta / kPi, degrees));
    const auto order0 = Normalized(CapEigenvaluesOfOrder(f, beta, 0));
    const std::string name = FormattedText("Phong s = 100, beta = pi/%d", part);
    report.Draw(FormattedText("figure6_pi_%d", part),
                {"Cap eigenvalues (m = 0) and zonal coefficients: " +
                     FormattedText("s = 100, beta = pi/%d", part),
                 "index or degree",
                 "share of the sum",
                 ChartScale::kLinear,
                 {First("eigenvalues", order0, 30), First("coefficients", stretched, 30)}});
    report.Note("Figure 6: order 0, " + name,
                FormattedText("%.1f %%", 100 * SummedDifference(order0, stretched)));
    const auto all = Normalized(CapEigenvalues(f, beta));
    const auto with_multiplicity = [&](double reach) {
      return Normalized(WithMultiplicity(ScaledCoefficients(g, reach / kPi, degrees)));
    };
    report.Note(
        "Figure 6: all orders, " + name,
        FormattedText("%.1f %% (stretched from beta), %.1f %% (of equal area)",
                      100 * SummedDifference(all, with_multiplicity(beta)),
                      100 * SummedDifference(all, with_multiplicity(kPi * std::sin(beta / 2)))));
  }
}

void DrawScaleTheorem(MahajanReport& report) {
  for (const double exponent : {100.0, 500.0}) {
    const auto g = SquaredCoefficients(PhongZonalCoefficients(exponent, Degrees(exponent)));
    const int degrees = SignificantDegrees(g);
    const auto narrow = ScaledCoefficients(g, 2, 2 * degrees);
    ChartCurve whole{"G(l)", {}, {}}, halved{"4 G'(2 l)", {}, {}};
    double worst = 0;
    for (int l = 0; l < degrees; ++l) {
      whole.x.push_back(l), whole.y.push_back(g[l] / g[0]);
      halved.x.push_back(l), halved.y.push_back(4 * narrow[2 * l] / g[0]);
      worst = std::max(worst, std::abs(whole.y.back() - halved.y.back()));
    }
    report.Note(FormattedText("Figure 6c, d: scale theorem, Phong s = %g", exponent),
                FormattedText("largest difference %.1f %% of G(0)", 100 * worst));
    report.Draw(FormattedText("figure6_scale_%g", exponent),
                {FormattedText("Scale theorem, g'(theta) = g(2 theta), Phong s = %g", exponent),
                 "degree l",
                 "relative to G(0)",
                 ChartScale::kLinear,
                 {whole, halved}});
  }
}

// A sphere seen from afar mirrors equal areas of its picture into equal solid angles, so a disc
// about its middle that takes the share A of the picture is a cap that takes the share A of the
// sphere of directions.
void DrawFigure7a(MahajanReport& report) {
  std::vector<ChartCurve> curves;
  for (const double exponent : {20.0, 100.0, 500.0, 2000.0}) {
    const auto f = PhongZonalCoefficients(exponent, Degrees(exponent));
    ChartCurve curve{FormattedText("Phong s = %g", exponent), {}, {}};
    for (int octave = -9; octave <= 0; ++octave) {
      const double share = std::exp2(octave);
      curve.x.push_back(share);
      curve.y.push_back(DimensionOf(CapEigenvalues(f, std::acos(1 - 2 * share)), kShare));
    }
    const auto fit = FitSlope(curve.x, curve.y);
    const std::string what = "Figure 7a: convex hemisphere (exact), " + curve.name;
    if (exponent < 500) {
      report.Note(what, SlopeText(fit));
    } else {
      report.AddSlope(what, fit, 0.9, 9);
    }
    curves.push_back(std::move(curve));
  }
  report.Draw("figure7a", {"Convex Phong hemisphere: 99.95 % of the energy",
                           "share of the hemisphere's picture", "terms", ChartScale::kLogarithmic,
                           curves, ChartScale::kLogarithmic});
}

}  // namespace

void DrawSpheres(MahajanReport& report) {
  DrawFigure6(report);
  DrawScaleTheorem(report);
  DrawFigure7a(report);
}

}  // namespace lfm
