// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/report.h"

#include <algorithm>
#include <chrono>
#include <optional>

#include "core/atomic_file.h"
#include "core/json_reader.h"
#include "core/process_memory.h"
#include "pipeline/report_page.h"
#include "pipeline/report_pictures.h"
#include "pipeline/stage_cache.h"
#include "pipeline/truth_record.h"
#include "viewer/web_page.h"

namespace lfm {

using nlohmann::json;

json CollectReport(const Capture& capture, const Workspace& workspace) {
  json report = json::object(), time = json::object(), options = json::object();
  double total = 0, peak = PeakMemoryMib();
  for (const char* stage : kStages) {
    if (std::string(stage) == "report") continue;
    const StageRecord record = ReadStageRecord(workspace.folder, stage);
    if (!ResultsAreAsRecorded(workspace.folder, stage)) {
      report[stage] = {{"out_of_date",
                        "files of this stage were changed after lfm-pipeline made them, so its "
                        "figures are left out; run 'lfm-pipeline run' again"}};
      continue;
    }
    report[stage] = record.figures;
    options[stage] = record.options;
    time[std::string(stage) + "_s"] = record.elapsed_in_seconds;
    total += record.elapsed_in_seconds;
    peak = std::max(peak, record.peak_memory_mib);
  }
  time["total_s"] = total;
  report["time"] = time;
  report["memory"] = {{"peak_mib", peak}};
  report["options"] = options;
  if (const std::optional<json> truth = FindTruth(capture, workspace)) {
    report["truth"] = truth->at("truth");
    report["evaluate"] = truth->at("evaluate");
  }
  return report;
}

void WriteReport(const Capture& capture, const Workspace& workspace,
                 const std::filesystem::path& folder, Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  json report = CollectReport(capture, workspace);
  for (const auto& [stage, figures] : report.items()) {
    if (figures.contains("out_of_date")) progress.Note(stage + " is out of date in the report");
  }
  const std::vector<ReportPicture> pictures =
      MakeReportPictures(capture, workspace, folder / "pictures", progress);
  WriteWebFolder(ReadFile(workspace.folder / "encode" / "model.glb"), capture.name, folder / "web");
  const double elapsed =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  report["time"]["report_s"] = elapsed;
  report["time"]["total_s"] = report["time"]["total_s"].get<double>() + elapsed;
  WriteJson(report, folder / "report.json");
  WriteReportPage(capture.name, report, pictures, folder / "index.html");
}

}  // namespace lfm
