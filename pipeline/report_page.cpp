// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/report_page.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/atomic_file.h"
#include "core/markup_text.h"
#include "pipeline/page_style.h"

namespace lfm {
namespace {

using nlohmann::json;

std::string Format(const json& value) {
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_integer()) return std::to_string(value.get<int64_t>());
  if (!value.is_number()) return value.dump();
  const double number = value.get<double>();
  std::ostringstream text;
  text.precision(std::abs(number) >= 100 ? 5 : 4);
  text << number;
  return text.str();
}

struct StageText {
  const char* name;
  const char* title;
  const char* lead;
};
constexpr StageText kStageTexts[] = {
    {"calib", "Cameras", "Where every photograph and scan was taken from."},
    {"scan", "Scans", "What structured light measured of the shape."},
    {"mesh", "Surface", "The dense surface and the mesh that carries the light field."},
    {"resample", "Resampling", "Which photographs saw which part of the surface."},
    {"encode", "Light field maps", "The factorised, quantised light field."},
    {"evaluate", "Held-out photographs", "The model beside photographs that it never saw."},
    {"truth", "Against the truth", "Only synthetic captures know it."}};

// Figures in a table; lists of objects become tables of their own elsewhere.
std::string FigureTable(const json& figures) {
  std::string html = "<table>";
  for (const auto& [key, value] : figures.items()) {
    if (value.is_structured()) continue;
    html += "<tr><td>" + EscapeMarkup(key) + "</td><td class=n>" + EscapeMarkup(Format(value)) +
            "</td></tr>";
  }
  return html + "</table>";
}

// What a stage set aside, or could not score: ids and reasons.
std::string ReasonTable(const json& figures, const char* key, const char* title) {
  if (!figures.contains(key) || figures[key].empty()) return "";
  std::string html = std::string("<p>") + title + ":</p><table>";
  for (const json& entry : figures[key]) {
    html += "<tr><td>" + EscapeMarkup(entry.value("id", "")) + "</td><td>" +
            EscapeMarkup(entry.value("reason", "")) + "</td></tr>";
  }
  return html + "</table>";
}

// Models that were tried, each with the error on corners kept out of its fit; the chosen one in
// bold.
std::string TrialTable(const json& trials, const std::string& title) {
  if (!trials.is_array() || trials.empty()) return "";
  std::string html =
      "<p>" + EscapeMarkup(title) +
      "</p><table><tr><th>model</th><th>error on corners kept out of the fit, px</th>"
      "</tr>";
  for (const json& trial : trials) {
    const bool chosen = trial.value("chosen", false);
    const std::string error = trial.contains("heldout_rms_px")
                                  ? Format(trial["heldout_rms_px"])
                                  : "no lens: folds over inside the picture";
    html += std::string("<tr><td>") + (chosen ? "<b>" : "") +
            EscapeMarkup(trial.value("model", "")) + (chosen ? "</b>" : "") + "</td><td class=n>" +
            EscapeMarkup(error) + "</td></tr>";
  }
  return html + "</table>";
}

std::string ModelTables(const json& figures) {
  std::string html;
  if (figures.contains("lens_trials")) {
    for (const auto& [camera, trials] : figures["lens_trials"].items()) {
      html += TrialTable(trials, "What the lens of camera " + camera + " required:");
    }
  }
  if (figures.contains("platform_trials")) {
    html += TrialTable(figures["platform_trials"], "What the platform required:");
  }
  return html;
}

std::string PhotoTable(const json& figures) {
  if (!figures.contains("photos") || figures["photos"].empty()) return "";
  std::string html =
      "<table><tr><th>photograph</th><th>PSNR dB</th><th>mean view alone, dB</th>"
      "<th>SSIM</th><th>APE</th></tr>";
  for (const json& photo : figures["photos"]) {
    const json& full = photo.at("full");
    html += "<tr><td>" + EscapeMarkup(photo.value("id", "")) + "</td><td class=n>" +
            Format(full.at("psnr_db")) + "</td><td class=n>" +
            (photo.contains("mean_only") ? Format(photo["mean_only"].at("psnr_db")) : "") +
            "</td><td class=n>" + Format(full.at("ssim")) + "</td><td class=n>" +
            Format(full.at("ape")) + "</td></tr>";
  }
  return html + "</table>";
}

// Horizontal bars with a label each.
std::string BarChart(const std::vector<std::pair<std::string, double>>& bars,
                     const std::string& unit) {
  double largest = 1e-12;
  for (const auto& [label, value] : bars) largest = std::max(largest, value);
  constexpr int kRow = 22, kLabel = 110, kBar = 500;
  std::string svg = "<svg width=\"760\" height=\"" +
                    std::to_string(kRow * static_cast<int>(bars.size()) + 4) + "\">";
  int y = 0;
  for (const auto& [label, value] : bars) {
    const std::string middle = std::to_string(y + 15);
    svg += "<text x=\"0\" y=\"" + middle + "\">" + EscapeMarkup(label) + "</text><rect x=\"" +
           std::to_string(kLabel) + "\" y=\"" + std::to_string(y + 3) +
           "\" height=\"16\" width=\"" +
           std::to_string(std::max(1, static_cast<int>(kBar * value / largest))) +
           "\" fill=\"#4a7ab5\"/><text x=\"" +
           std::to_string(kLabel + 8 + static_cast<int>(kBar * value / largest)) + "\" y=\"" +
           middle + "\">" + Format(value) + EscapeMarkup(unit) + "</text>";
    y += kRow;
  }
  return svg + "</svg>";
}

std::string KeyFigures(const json& report) {
  std::string html = "<div class=key>";
  const auto add = [&](const char* stage, const char* key, const char* label, const char* unit) {
    if (!report.contains(stage) || !report[stage].contains(key)) return;
    html +=
        "<div><b>" + EscapeMarkup(Format(report[stage][key])) + unit + "</b>" + label + "</div>";
  };
  add("evaluate", "heldout_psnr_db", "held-out PSNR", " dB");
  add("evaluate", "heldout_psnr_mean_only_db", "mean view alone", " dB");
  add("encode", "compression_ratio", "compression", " : 1");
  add("encode", "model_bytes", "model file", " bytes");
  add("encode", "transport_bytes", "for transport", " bytes");
  add("time", "total_s", "whole pipeline", " s");
  add("memory", "peak_mib", "peak memory", " MiB");
  return html + "</div>";
}

std::string Charts(const std::string& stage, const json& report) {
  if (stage != "encode" || !report["encode"].contains("singular_value_share")) return "";
  std::vector<std::pair<std::string, double>> bars;
  for (const json& share : report["encode"]["singular_value_share"]) {
    bars.emplace_back("term " + std::to_string(bars.size() + 1), 100 * share.get<double>());
  }
  return "<p>Share of the light field's energy beyond the mean view, term by term:</p>" +
         BarChart(bars, " %");
}

std::string TimeChart(const json& time) {
  std::vector<std::pair<std::string, double>> bars;
  for (const StageText& stage : kStageTexts) {
    const std::string key = std::string(stage.name) + "_s";
    if (time.contains(key)) bars.emplace_back(stage.name, time[key].get<double>());
  }
  return BarChart(bars, " s");
}

// WriteWebFolder's pages beside this one. The one in a single file needs no server.
constexpr const char* kLiveModel =
    "<h2 id=model>The model</h2><p class=lead>Drag to turn, wheel or two fingers to zoom. <a "
    "href=\"web/model.html\">On a page of its own</a> (one file, to be passed on); for a web "
    "server: the folder <a href=\"web/\">web</a>.</p><iframe src=\"web/model.html\" title=\"The "
    "model, "
    "to be turned\" allow=fullscreen allowfullscreen></iframe>";

}  // namespace

void WriteReportPage(const std::string& capture_name, const json& report,
                     const std::vector<ReportPicture>& pictures,
                     const std::filesystem::path& file) {
  std::string html = "<!doctype html><html lang=en><meta charset=utf-8><title>" +
                     EscapeMarkup(capture_name) +
                     " – lfm report</title><meta name=viewport "
                     "content=\"width=device-width\"><style>" +
                     kPageStyle + "</style><h1>" + EscapeMarkup(capture_name) +
                     "</h1><p class=lead>From photographs and scans to a surface light field.</p>" +
                     KeyFigures(report) + kLiveModel;
  for (const StageText& stage : kStageTexts) {
    if (!report.contains(stage.name)) continue;
    const json& figures = report[stage.name];
    html += std::string("<h2 id=") + stage.name + ">" + stage.title + "</h2><p class=lead>" +
            stage.lead + "</p>" + FigureTable(figures) +
            ReasonTable(figures, "rejected", "Set aside") +
            ReasonTable(figures, "missing", "Not scored") + ModelTables(figures) +
            Charts(stage.name, report);
    for (const ReportPicture& picture : pictures) {
      if (picture.stage != stage.name) continue;
      html += "<figure><img loading=lazy src=\"" + EscapeMarkup(picture.file) + "\" alt=\"" +
              EscapeMarkup(picture.caption) + "\"><figcaption>" + EscapeMarkup(picture.caption) +
              "</figcaption></figure>";
    }
    if (std::string(stage.name) == "evaluate") html += PhotoTable(figures);
  }
  html += "<h2 id=time>Time and memory</h2>" + TimeChart(report["time"]) +
          FigureTable(report["time"]) + FigureTable(report["memory"]);
  html += "<h2 id=options>Options</h2><pre>" + EscapeMarkup(report["options"].dump(2)) +
          "</pre></html>\n";
  WriteFileAtomically(file, html);
}

}  // namespace lfm
