// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace lfm {

/// One curve of a chart: points in order.
struct ChartCurve {
  std::string name;
  std::vector<double> x, y;
};

enum class ChartScale { kLinear, kLogarithmic };

struct LineChart {
  std::string title, x_label, y_label;
  ChartScale x_scale = ChartScale::kLinear;
  std::vector<ChartCurve> curves;
};

/// An SVG picture of the curves with axes, ticks at round numbers and a legend. Points that are not
/// finite (or not positive on a logarithmic scale) are left out; without any point the axes go from
/// 0 to 1 (1 to 10).
std::string ChartToSvg(const LineChart& chart);

}  // namespace lfm
