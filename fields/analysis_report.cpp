// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/formatted_text.h"
#include "core/line_chart.h"
#include "fields/analysis.h"

namespace lfm {
namespace {

constexpr size_t kMostCurves = 8;  // a chart tells so many colours apart

nlohmann::json SlopeToJson(const SlopeFit& fit) {
  nlohmann::json json = {{"slope", fit.slope},
                         {"points", fit.points},
                         {"from_area", fit.from_area},
                         {"to_area", fit.to_area}};
  if (fit.half_width) json["half_width"] = *fit.half_width;
  return json;
}

nlohmann::json CurveToJson(const DimensionCurve& curve) {
  nlohmann::json json = {
      {"center", curve.center}, {"areas", curve.areas}, {"dimensions", curve.dimensions}};
  if (curve.slope) json["slope"] = SlopeToJson(*curve.slope);
  json["local_slopes"] = nlohmann::json::array();
  for (const LocalSlope& local : LocalSlopes(curve.areas, curve.dimensions)) {
    json["local_slopes"].push_back({{"area", local.area}, {"slope", local.slope}});
  }
  return json;
}

}  // namespace

nlohmann::json AnalysisToJson(const AnalysisResult& result) {
  nlohmann::json json = {{"name", result.name},
                         {"points", result.points},
                         {"occupied", result.occupied},
                         {"columns", result.columns},
                         {"global_terms", result.global_terms},
                         {"global_rows", result.global_rows},
                         {"curves", nlohmann::json::array()},
                         {"predictions", nlohmann::json::array()},
                         {"block_costs", nlohmann::json::array()}};
  if (result.slope) json["slope"] = *result.slope;
  if (result.slope_half_width) json["slope_half_width"] = *result.slope_half_width;
  for (const DimensionCurve& curve : result.curves) json["curves"].push_back(CurveToJson(curve));
  for (const SizePrediction& prediction : result.predictions) {
    json["predictions"].push_back(
        {{"parts", prediction.shrinkage.parts}, {"mu", prediction.shrinkage.mu}});
    if (std::isfinite(prediction.pixels)) json["predictions"].back()["pixels"] = prediction.pixels;
  }
  for (const BlockCost& block : result.block_costs) {
    json["block_costs"].push_back({{"side", block.side},
                                   {"overhead", block.cost.overhead},
                                   {"per_pixel", block.cost.per_pixel},
                                   {"total_per_pixel", block.cost.PerPixel()}});
  }
  return json;
}

std::string AnalysisToSvg(const AnalysisResult& result) {
  LineChart chart{"Dimensionality against area: " + result.name,
                  "points of the patch",
                  "terms",
                  ChartScale::kLogarithmic,
                  {},
                  ChartScale::kLogarithmic};
  for (size_t i = 0; i < std::min(kMostCurves, result.curves.size()); ++i) {
    const DimensionCurve& curve = result.curves[i];
    std::string name = "about " + std::to_string(curve.center);
    if (curve.slope) name += FormattedText(": %.2f", curve.slope->slope);
    chart.curves.push_back({name, curve.areas, curve.dimensions});
  }
  return ChartToSvg(chart);
}

std::string BlockCostsToSvg(const AnalysisResult& result) {
  std::vector<double> areas, overhead, per_pixel, total;
  for (const BlockCost& block : result.block_costs) {
    const auto pixels = static_cast<double>(std::max<int64_t>(block.cost.pixels, 1));
    areas.push_back(static_cast<double>(block.side) * block.side);
    overhead.push_back(block.cost.overhead / pixels);
    per_pixel.push_back(block.cost.per_pixel / pixels);
    total.push_back(block.cost.PerPixel());
  }
  return ChartToSvg({"Cost against the size of blocks: " + result.name,
                     "pixels of a block",
                     "basis functions a pixel",
                     ChartScale::kLogarithmic,
                     {{"global to local", areas, overhead},
                      {"local to pixels", areas, per_pixel},
                      {"total", areas, total}},
                     ChartScale::kLogarithmic});
}

std::vector<std::string> Findings(const AnalysisResult& result) {
  std::vector<std::string> lines;
  lines.push_back(FormattedText("%s: %lld of %lld points occupied, %d directions",
                                result.name.c_str(), static_cast<long long>(result.occupied),
                                static_cast<long long>(result.points), result.columns));
  for (const DimensionCurve& curve : result.curves) {
    std::string line = "point " + std::to_string(curve.center) + ": ";
    if (!curve.slope) {
      lines.push_back(line + "too few patches for a slope");
      continue;
    }
    line += FormattedText("slope %.2f", curve.slope->slope);
    if (curve.slope->half_width) line += FormattedText(" +- %.2f", *curve.slope->half_width);
    lines.push_back(line + FormattedText(", areas %.0f to %.0f, %.0f to %.0f terms",
                                         curve.areas.front(), curve.areas.back(),
                                         curve.dimensions.front(), curve.dimensions.back()));
  }
  if (result.slope) {
    std::string line = FormattedText("mean slope %.2f", *result.slope);
    if (result.slope_half_width) line += FormattedText(" +- %.2f", *result.slope_half_width);
    lines.push_back(line);
  }
  lines.push_back(FormattedText("N = %lld terms, from %lld points",
                                static_cast<long long>(result.global_terms),
                                static_cast<long long>(result.global_rows)));
  for (const SizePrediction& prediction : result.predictions) {
    std::string line = FormattedText(
        "%s: mu = %.2f, ", prediction.shrinkage.parts == 2 ? "clusters (r = 2)" : "blocks (r = 4)",
        prediction.shrinkage.mu);
    line += !std::isfinite(prediction.pixels) ? "patches may grow without bound"
            : prediction.pixels <= 0
                ? "patches should be as small as can be"
                : FormattedText("predicted patch p* = %.0f points", prediction.pixels);
    lines.push_back(line);
  }
  if (!result.block_costs.empty()) {
    const BlockCost& best = *std::min_element(
        result.block_costs.begin(), result.block_costs.end(),
        [](const BlockCost& a, const BlockCost& b) { return a.cost.Total() < b.cost.Total(); });
    lines.push_back(FormattedText(
        "measured: blocks of %d x %d cost least, %.1f basis functions a pixel (N = %lld)",
        best.side, best.side, best.cost.PerPixel(), static_cast<long long>(result.global_terms)));
  }
  return lines;
}

}  // namespace lfm
