// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
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
                         {"predictions", nlohmann::json::array()}};
  if (result.slope) json["slope"] = *result.slope;
  if (result.slope_half_width) json["slope_half_width"] = *result.slope_half_width;
  for (const DimensionCurve& curve : result.curves) json["curves"].push_back(CurveToJson(curve));
  for (const SizePrediction& prediction : result.predictions) {
    json["predictions"].push_back({{"parts", prediction.parts}, {"mu", prediction.mu}});
    if (prediction.points) json["predictions"].back()["points"] = *prediction.points;
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
    std::string line =
        FormattedText("%s: mu = %.2f, ",
                      prediction.parts == 2 ? "clusters (r = 2)" : "blocks (r = 4)", prediction.mu);
    line += !prediction.points ? "patches may grow without bound"
            : *prediction.points <= 0
                ? "patches should be as small as can be"
                : FormattedText("predicted patch p* = %.0f points", *prediction.points);
    lines.push_back(line);
  }
  return lines;
}

}  // namespace lfm
