// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/light_report.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "core/atomic_file.h"
#include "core/json_reader.h"
#include "core/line_chart.h"
#include "core/markup_text.h"
#include "fields/field_encoding.h"
#include "fields/relightable_file.h"
#include "pipeline/page_style.h"
#include "pipeline/stage_cache.h"
#include "viewer/relight_page.h"

namespace lfm {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

std::string Number(double value, const char* format) {
  char text[40];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

json CollectLightReport(const Workspace& workspace) {
  json report = json::object(), time = json::object();
  double total = 0, peak = 0;
  for (const char* stage : {"encode", "evaluate"}) {
    const StageRecord record = ReadStageRecord(workspace.folder, stage);
    report[stage] = record.figures;
    if (!ResultsAreAsRecorded(workspace.folder, stage)) {
      report[stage] = {{"out_of_date",
                        "files of this stage were changed after lfm-pipeline made them, so its "
                        "figures are left out; run 'lfm-pipeline run' again"}};
    }
    report["options"][stage] = record.options;
    time[std::string(stage) + "_s"] = record.elapsed_in_seconds;
    total += record.elapsed_in_seconds;
    peak = std::max(peak, record.peak_memory_mib);
  }
  time["total_s"] = total;
  report["time"] = time;
  report["memory"] = {{"peak_mib", peak}};
  return report;
}

std::string KeyFigures(const json& report) {
  std::string html = "<div class=key>";
  const auto add = [&](const char* stage, const char* key, const char* label, const char* format) {
    if (!report[stage].contains(key)) return;
    html +=
        "<div><b>" + Number(report[stage][key].get<double>(), format) + "</b>" + label + "</div>";
  };
  add("evaluate", "heldout_psnr_db", "PSNR on held-out lights", "%.2f dB");
  add("evaluate", "heldout_ssim", "SSIM", "%.4f");
  add("encode", "compression_ratio", "against 8-bit pictures", "%.1f : 1");
  add("encode", "model_bytes", "model file", "%.0f bytes");
  add("time", "total_s", "encoding and evaluation", "%.1f s");
  add("memory", "peak_mib", "peak memory", "%.0f MiB");
  return html + "</div>";
}

std::string MethodTable(const json& evaluate) {
  std::string html =
      "<table><tr><th>method</th><th>bytes</th><th>PSNR dB</th><th>SSIM</th><th>APE</th>"
      "<th>relative error</th></tr>";
  for (const json& method : evaluate["methods"]) {
    html += "<tr><td>" + EscapeMarkup(method.value("name", "")) + "</td><td class=n>" +
            std::to_string(method.value("bytes", int64_t{0})) + "</td>";
    if (method.contains("psnr_db")) {
      const auto cell = [&](const char* key, const char* format) {
        html += "<td class=n>" + Number(method[key].get<double>(), format) + "</td>";
      };
      cell("psnr_db", "%.2f");
      cell("ssim", "%.4f");
      cell("ape", "%.2f");
      cell("relative_error", "%.5f");
    }
    html += "</tr>";
  }
  return html + "</table>";
}

// A curve a family of methods, by rising bytes.
LineChart BytesChart(const json& evaluate, const char* key, const char* label, ChartScale scale) {
  std::map<std::string, std::vector<std::pair<double, double>>> families;
  for (const json& method : evaluate["methods"]) {
    families[method.value("family", "")].emplace_back(method["bytes"].get<double>(),
                                                      method[key].get<double>());
  }
  LineChart chart{std::string(label) + " on held-out lights against bytes", "bytes", label,
                  ChartScale::kLogarithmic};
  chart.y_scale = scale;
  for (auto& [family, points] : families) {
    std::sort(points.begin(), points.end());
    ChartCurve curve;
    curve.name = family;
    for (const auto& [bytes, value] : points) {
      curve.x.push_back(bytes);
      curve.y.push_back(value);
    }
    chart.curves.push_back(curve);
  }
  return chart;
}

LineChart HeightChart(const json& evaluate) {
  LineChart chart{"Every held-out light by its height above the horizon", "height, degrees",
                  "PSNR, dB"};
  const auto heights = evaluate["light_heights"].get<std::vector<double>>();
  std::vector<size_t> order(heights.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return heights[a] < heights[b]; });
  for (const json& method : evaluate["methods"]) {
    const std::string name = method.value("name", "");
    const bool model = name.find("all residuals") != std::string::npos;
    if (!model && name != "interpolated pictures" && name != "HSH 16" && name != "PTM") continue;
    const auto psnr = method["light_psnr_db"].get<std::vector<double>>();
    ChartCurve curve;
    curve.name = name;
    for (size_t i : order) {
      curve.x.push_back(heights[i] * 180 / std::numbers::pi);
      curve.y.push_back(psnr[i]);
    }
    chart.curves.push_back(curve);
  }
  return chart;
}

std::string FigureTable(const json& figures) {
  std::string html = "<table>";
  for (const auto& [key, value] : figures.items()) {
    if (value.is_structured()) continue;
    const std::string text = value.is_string()         ? value.get<std::string>()
                             : value.is_number_float() ? Number(value.get<double>(), "%.5g")
                                                       : value.dump();
    html +=
        "<tr><td>" + EscapeMarkup(key) + "</td><td class=n>" + EscapeMarkup(text) + "</td></tr>";
  }
  return html + "</table>";
}

std::string Figure(const std::string& file, const std::string& caption) {
  return "<figure><img loading=lazy src=\"" + EscapeMarkup(file) + "\" alt=\"" +
         EscapeMarkup(caption) + "\"><figcaption>" + EscapeMarkup(caption) +
         "</figcaption></figure>";
}

std::string EvaluationSection(const json& evaluate) {
  std::string html =
      "<h2 id=evaluate>Held-out lights</h2><p class=lead>What each method shows under lights "
      "that no training picture was taken with: differences of 8-bit sRGB values over the "
      "object's pixels, and the relative squared error of linear radiance. Pictures count a byte "
      "a value.</p>";
  if (evaluate.contains("note")) {
    html += "<p>" + EscapeMarkup(evaluate["note"].get<std::string>()) + "</p>";
  }
  if (!evaluate.contains("methods")) return html + FigureTable(evaluate);
  html += MethodTable(evaluate);
  if (evaluate["lights"].get<int>() > 0) {
    html += ChartToSvg(BytesChart(evaluate, "psnr_db", "PSNR, dB", ChartScale::kLinear)) +
            ChartToSvg(BytesChart(evaluate, "relative_error", "relative error",
                                  ChartScale::kLogarithmic)) +
            ChartToSvg(HeightChart(evaluate));
  }
  for (const json& picture : evaluate.value("pictures", json::array())) {
    html += Figure("pictures/" + picture.value("file", ""), picture.value("caption", ""));
  }
  return html + FigureTable(evaluate);
}

constexpr const char* kLiveModel =
    "<h2 id=model>The model</h2><p class=lead>Drag to move the light. <a "
    "href=\"web/relight.html\">On a page of its own</a> (one file, to be passed on); for a web "
    "server: the folder <a href=\"web/\">web</a>.</p><iframe src=\"web/relight.html\" title=\"The "
    "model, to be relit\" allow=fullscreen allowfullscreen></iframe>";

// A page is passed on: more residuals than these are bytes that are hardly seen.
constexpr int kPageResiduals = 16;

void WritePages(const Capture& capture, const Workspace& workspace, const fs::path& folder) {
  std::optional<Eigen::Matrix3d> camera_from_world;
  if (capture.reflectance_field && capture.reflectance_field->camera_from_world) {
    camera_from_world = capture.reflectance_field->camera_from_world->rotation;
  }
  const RelightableModel model =
      WithFewerResiduals(ReadRelightable(workspace.RelightableFile()), kPageResiduals);
  WriteRelightPages(EncodeRelightable(model), capture.name, folder, camera_from_world);
}

}  // namespace

void WriteLightReport(const Capture& capture, const Workspace& workspace, const fs::path& folder) {
  const json report = CollectLightReport(workspace);
  for (const json& picture : report["evaluate"].value("pictures", json::array())) {
    const std::string file = picture.value("file", "");
    WriteFileAtomically(folder / "pictures" / file,
                        ReadFile(workspace.Stage("evaluate") / "pictures" / file));
  }
  WriteJson(report, folder / "report.json");
  const bool is_current = !report["encode"].contains("out_of_date");
  if (is_current) WritePages(capture, workspace, folder / "web");
  const std::string html =
      "<!doctype html><html lang=en><meta charset=utf-8><title>" + EscapeMarkup(capture.name) +
      " – lfm report</title><meta name=viewport content=\"width=device-width\"><style>" +
      kPageStyle + "</style><h1>" + EscapeMarkup(capture.name) +
      "</h1><p class=lead>From pictures under many lights to a model that can be relit.</p>" +
      KeyFigures(report) + (is_current ? kLiveModel : "") + EvaluationSection(report["evaluate"]) +
      "<h2 id=encode>Encoding</h2><p class=lead>Clusters of pixels with a basis each, weights and "
      "a sparse residual: <code>encode/model.lfr</code>.</p>" +
      FigureTable(report["encode"]) + "<h2 id=time>Time and memory</h2>" +
      FigureTable(report["time"]) + FigureTable(report["memory"]) +
      "<h2 id=options>Options</h2><pre>" + EscapeMarkup(report["options"].dump(2)) +
      "</pre></html>\n";
  WriteFileAtomically(folder / "index.html", html);
}

}  // namespace lfm
