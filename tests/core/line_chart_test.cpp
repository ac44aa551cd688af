// SPDX-License-Identifier: BSD-3-Clause
#include "core/line_chart.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <limits>

namespace lfm {
namespace {

// Heights in pixels of the dots of an SVG picture, in order.
std::vector<double> DotHeights(const std::string& svg) {
  std::vector<double> heights;
  for (size_t at = svg.find("<circle"); at != std::string::npos; at = svg.find("<circle", at + 1)) {
    double x = 0, y = 0;
    EXPECT_EQ(std::sscanf(svg.c_str() + at, "<circle cx=\"%lf\" cy=\"%lf\"", &x, &y), 2);
    heights.push_back(y);
  }
  return heights;
}

TEST(LineChart, EachSideHasItsOwnAxis) {
  const ChartCurve left{"left", {1, 2}, {1, 10}},
      right{"right", {1, 2}, {1e4, 1e5}, ChartSide::kRight};
  LineChart chart{.title = "a < b", .x_label = "x", .y_label = "y", .curves = {left, right}};
  chart.right_label = "z & more";
  const std::string svg = ChartToSvg(chart);
  const std::vector<double> dots = DotHeights(svg);
  ASSERT_EQ(dots.size(), 4U);
  EXPECT_LT(dots[1], dots[0]);  // larger is higher
  EXPECT_EQ(dots[2], dots[0]);
  EXPECT_EQ(dots[3], dots[1]);
  EXPECT_NE(svg.find("a &lt; b"), std::string::npos);
  EXPECT_NE(svg.find("z &amp; more"), std::string::npos);
  chart.curves[1].side = ChartSide::kLeft;
  EXPECT_GT(DotHeights(ChartToSvg(chart))[1], dots[1] + 100);  // one axis for 10 and 1e5
  EXPECT_EQ(ChartToSvg(chart).find("z &amp; more"), std::string::npos);
}

TEST(LineChart, ZeroHasNoSign) {
  const std::string svg = ChartToSvg(
      {.title = {}, .x_label = {}, .y_label = {}, .curves = {{"curve", {0, 30}, {0, 0.2}}}});
  EXPECT_NE(svg.find(">0</text>"), std::string::npos);
  EXPECT_EQ(svg.find(">-0</text>"), std::string::npos);
}

TEST(LineChart, LogarithmicAxesLeaveOutWhatTheyCannotShow) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ChartCurve curve{"curve", {1, 10, 100, 0, 5}, {1, 10, 100, 5, nan}};
  const std::string svg = ChartToSvg({.title = {},
                                      .x_label = {},
                                      .y_label = {},
                                      .x_scale = ChartScale::kLogarithmic,
                                      .curves = {curve},
                                      .y_scale = ChartScale::kLogarithmic});
  const std::vector<double> dots = DotHeights(svg);
  ASSERT_EQ(dots.size(), 3U);
  EXPECT_NEAR(dots[0] - dots[1], dots[1] - dots[2], 0.2);  // printed to a tenth of a pixel
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(DotHeights(ChartToSvg({})).size(), 0U);
}

}  // namespace
}  // namespace lfm
