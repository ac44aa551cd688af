// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace lfm {

/// Against which axis a curve is drawn.
enum class ChartSide { kLeft, kRight };

/// One curve of a chart: points in order.
struct ChartCurve {
  std::string name;
  std::vector<double> x, y;
  ChartSide side = ChartSide::kLeft;
};

enum class ChartScale { kLinear, kLogarithmic };

struct LineChart {
  std::string title, x_label, y_label;
  ChartScale x_scale = ChartScale::kLinear;
  std::vector<ChartCurve> curves = {};
  ChartScale y_scale = ChartScale::kLinear;  ///< of both sides
  std::string right_label = {};
};

/// An SVG picture of the curves with axes, ticks at round numbers and a legend. Points that are not
/// finite (or not positive on a logarithmic scale) are left out; without any point the axes go from
/// 0 to 1 (1 to 10). The axis on the right is there when a curve is.
std::string ChartToSvg(const LineChart& chart);

}  // namespace lfm
