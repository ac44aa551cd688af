// SPDX-License-Identifier: BSD-3-Clause
#include "core/line_chart.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/formatted_text.h"
#include "core/markup_text.h"

namespace lfm {
namespace {

constexpr double kLeft = 70, kRight = 560, kTop = 50, kBottom = 360;
constexpr const char* kColors[] = {"#1b6ca8", "#c0392b", "#27844a", "#8e44ad",
                                   "#b9770e", "#16858a", "#555555", "#d35490"};

struct Axis {
  ChartScale scale = ChartScale::kLinear;
  double low = 0, high = 1, from_px = 0, to_px = 1;
  double Position(double value) const {
    return scale == ChartScale::kLinear ? value : std::log10(value);
  }
  double At(double value) const {
    return from_px + (Position(value) - low) / (high - low) * (to_px - from_px);
  }
  bool Shows(double value) const {
    return std::isfinite(value) && (scale == ChartScale::kLinear || value > 0);
  }
};

Axis MakeAxis(const std::vector<double>& values, ChartScale scale, double from_px, double to_px) {
  Axis axis{scale, std::numeric_limits<double>::infinity(),
            -std::numeric_limits<double>::infinity(), from_px, to_px};
  for (const double value : values) {
    if (!axis.Shows(value)) continue;
    axis.low = std::min(axis.low, axis.Position(value));
    axis.high = std::max(axis.high, axis.Position(value));
  }
  if (!(axis.low <= axis.high)) axis.low = 0, axis.high = 1;
  const double margin = std::max(0.05 * (axis.high - axis.low), 0.02);
  axis.low -= margin;
  axis.high += margin;
  return axis;
}

std::vector<double> Ticks(const Axis& axis) {
  std::vector<double> ticks;
  if (axis.scale == ChartScale::kLogarithmic) {
    for (int decade = static_cast<int>(std::floor(axis.low)); decade <= axis.high; ++decade) {
      for (const double step : {1.0, 2.0, 5.0}) ticks.push_back(step * std::pow(10.0, decade));
    }
  } else {
    const double rough = (axis.high - axis.low) / 6;
    const double power = std::pow(10.0, std::floor(std::log10(rough)));
    const double step = power * (rough < 2 * power ? 2 : rough < 5 * power ? 5 : 10);
    for (double k = std::ceil(axis.low / step); k * step <= axis.high; ++k) {
      ticks.push_back(k * step + 0.0);  // no negative zero
    }
  }
  std::erase_if(ticks, [&](double tick) {
    return axis.Position(tick) < axis.low || axis.Position(tick) > axis.high;
  });
  return ticks;
}

std::string Frame(const LineChart& chart, const Axis& x, const Axis& y) {
  std::string svg = FormattedText(
      "<rect x=\"%g\" y=\"%g\" width=\"%g\" height=\"%g\" fill=\"none\" stroke=\"#888\"/>\n", kLeft,
      kTop, kRight - kLeft, kBottom - kTop);
  for (const double tick : Ticks(x)) {
    svg += FormattedText("<line x1=\"%.1f\" x2=\"%.1f\" y1=\"%g\" y2=\"%g\" stroke=\"#ddd\"/>\n",
                         x.At(tick), x.At(tick), kTop, kBottom);
    svg += FormattedText("<text x=\"%.1f\" y=\"%g\" text-anchor=\"middle\">%g</text>\n", x.At(tick),
                         kBottom + 18, tick);
  }
  for (const double tick : Ticks(y)) {
    svg += FormattedText("<line x1=\"%g\" x2=\"%g\" y1=\"%.1f\" y2=\"%.1f\" stroke=\"#ddd\"/>\n",
                         kLeft, kRight, y.At(tick), y.At(tick));
    svg += FormattedText("<text x=\"%g\" y=\"%.1f\" text-anchor=\"end\">%g</text>\n", kLeft - 6,
                         y.At(tick) + 4, tick);
  }
  const double middle_x = (kLeft + kRight) / 2, middle_y = (kTop + kBottom) / 2;
  svg += FormattedText("<text x=\"%g\" y=\"%g\" text-anchor=\"middle\">", middle_x, kBottom + 40);
  svg += EscapeMarkup(chart.x_label) + "</text>\n";
  svg += FormattedText("<text transform=\"translate(18 %g) rotate(-90)\" text-anchor=\"middle\">",
                       middle_y);
  svg += EscapeMarkup(chart.y_label) + "</text>\n";
  svg +=
      FormattedText("<text x=\"%g\" y=\"28\" text-anchor=\"middle\" font-size=\"15\">", middle_x);
  return svg + EscapeMarkup(chart.title) + "</text>\n";
}

// Ticks inside the frame: beside it stands the legend.
std::string RightAxis(const std::string& label, const Axis& y) {
  std::string svg;
  for (const double tick : Ticks(y)) {
    svg += FormattedText("<line x1=\"%g\" x2=\"%g\" y1=\"%.1f\" y2=\"%.1f\" stroke=\"#888\"/>\n",
                         kRight - 6, kRight, y.At(tick), y.At(tick));
    svg += FormattedText("<text x=\"%g\" y=\"%.1f\" text-anchor=\"end\">%g</text>\n", kRight - 9,
                         y.At(tick) + 4, tick);
  }
  svg += FormattedText("<text transform=\"translate(%g %g) rotate(-90)\" text-anchor=\"middle\">",
                       kRight + 18, (kTop + kBottom) / 2);
  return svg + EscapeMarkup(label) + "</text>\n";
}

std::string Curve(const ChartCurve& curve, size_t index, const Axis& x, const Axis& y) {
  const char* color = kColors[index % std::size(kColors)];
  std::string line = FormattedText(
                  "<polyline fill=\"none\" stroke-width=\"2\" stroke=\"%s\" points=\"", color),
              dots;
  for (size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i) {
    if (!x.Shows(curve.x[i]) || !y.Shows(curve.y[i])) continue;
    line += FormattedText("%.1f,%.1f ", x.At(curve.x[i]), y.At(curve.y[i]));
    dots += FormattedText("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3\" fill=\"%s\"/>\n",
                          x.At(curve.x[i]), y.At(curve.y[i]), color);
  }
  const double legend_y = kTop + 10 + 20 * static_cast<double>(index);
  const std::string legend = FormattedText(
                                 "<rect x=\"%g\" y=\"%g\" width=\"14\" height=\"4\" fill=\"%s\"/>"
                                 "<text x=\"%g\" y=\"%g\">",
                                 kRight + 24, legend_y, color, kRight + 44, legend_y + 6) +
                             EscapeMarkup(curve.name) + "</text>\n";
  return line + "\"/>\n" + dots + legend;
}

}  // namespace

std::string ChartToSvg(const LineChart& chart) {
  std::vector<double> xs, ys[2];
  for (const ChartCurve& curve : chart.curves) {
    std::vector<double>& own = ys[curve.side == ChartSide::kRight];
    xs.insert(xs.end(), curve.x.begin(), curve.x.end());
    own.insert(own.end(), curve.y.begin(), curve.y.end());
  }
  const Axis x = MakeAxis(xs, chart.x_scale, kLeft, kRight);
  const Axis left = MakeAxis(ys[0], chart.y_scale, kBottom, kTop);
  const Axis right = MakeAxis(ys[1], chart.y_scale, kBottom, kTop);
  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"760\" height=\"420\" "
      "font-family=\"system-ui,sans-serif\" font-size=\"12\">\n"
      "<rect width=\"760\" height=\"420\" fill=\"#fff\"/>\n" +
      Frame(chart, x, left);
  if (!ys[1].empty()) svg += RightAxis(chart.right_label, right);
  for (size_t i = 0; i < chart.curves.size(); ++i) {
    const ChartCurve& curve = chart.curves[i];
    svg += Curve(curve, i, x, curve.side == ChartSide::kRight ? right : left);
  }
  return svg + "</svg>\n";
}

}  // namespace lfm
