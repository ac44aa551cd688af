// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/pipeline.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "calib/board.h"
#include "calib/calib_files.h"
#include "core/capture.h"
#include "core/error.h"
#include "core/json_reader.h"
#include "core/output_folder.h"
#include "core/ply.h"
#include "encode/encode_files.h"
#include "encode/memory_need.h"
#include "mesh/mesh_files.h"
#include "pipeline/evaluation.h"
#include "pipeline/report.h"
#include "pipeline/workspace.h"
#include "pipeline/workspace_lock.h"
#include "resample/photo_gains.h"
#include "scan/scan_files.h"
#include "scan/scan_report.h"

namespace lfm {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

// Everything that the jobs of one run share.
struct Run {
  Capture capture;
  Workspace workspace;
  PipelineOptions options;
  Progress& progress;

  std::vector<fs::path> PhotoFiles() const {
    std::vector<fs::path> files;
    for (const Photo& photo : capture.photos) {
      files.push_back(capture.folder / photo.file);
      if (!photo.mask.empty()) files.push_back(capture.folder / photo.mask);
    }
    return files;
  }
  std::vector<fs::path> ScannerFiles() const {
    std::vector<fs::path> files;
    if (!capture.scanner) return files;
    for (const auto* sets : {&capture.scanner->scans, &capture.scanner->placements}) {
      for (const ScanSet& set : *sets) {
        for (const std::string& frame : set.frames) files.push_back(capture.folder / frame);
      }
    }
    return files;
  }
  // The manifest decides every stage; the board the calibration.
  std::vector<fs::path> ManifestFiles() const {
    std::vector<fs::path> files = {capture.folder / "capture.json"};
    if (!capture.board.empty()) files.push_back(capture.folder / capture.board);
    return files;
  }
};

// By value: declaring options hands out references to them.
template <typename Options>
json ToJson(Options options) {
  return OptionsToJson(AnyOptions(options));
}

// What decides about no result is no reason to do a stage again.
json WithoutMemory(json options) {
  options.erase("memory-mib");
  options.erase("encode-memory-mib");
  return options;
}

template <typename... Lists>
std::vector<fs::path> Join(const Lists&... lists) {
  std::vector<fs::path> all;
  (all.insert(all.end(), lists.begin(), lists.end()), ...);
  return all;
}

json RejectedToJson(const std::vector<std::pair<std::string, std::string>>& rejected) {
  json list = json::array();
  for (const auto& [id, reason] : rejected) list.push_back({{"id", id}, {"reason", reason}});
  return list;
}

// Models in the order in which they were tried; those that were no lens have no error.
json TrialToJson(const std::string& model, double heldout_rms_px, bool chosen) {
  json trial = {{"model", model}, {"chosen", chosen}};
  if (std::isfinite(heldout_rms_px)) trial["heldout_rms_px"] = heldout_rms_px;
  return trial;
}

json LensTrialsToJson(const CalibResult& result) {
  json cameras = json::object();
  for (const auto& [name, trials] : result.lens_trials) {
    cameras[name] = json::array();
    for (const LensTrial& trial : trials) {
      cameras[name].push_back(TrialToJson(LensModelName(trial.terms), trial.heldout_rms_px,
                                          trial.terms == result.lens_terms.at(name)));
    }
  }
  return cameras;
}

json PlatformTrialsToJson(const CalibResult& result) {
  json trials = json::array();
  for (const PlatformTrial& trial : result.platform_trials) {
    trials.push_back(
        TrialToJson(trial.model, trial.heldout_rms_px, trial.model == result.platform_model));
  }
  return trials;
}

json CalibFigures(const Capture& capture, const CalibResult& result) {
  std::vector<std::pair<std::string, std::string>> rejected;
  for (const RejectedImage& r : result.rejected) rejected.emplace_back(r.id, r.reason);
  // No two pictures of a capture share an id.
  const auto count = [&](const auto& pictures) {
    return std::count_if(result.rejected.begin(), result.rejected.end(), [&](const auto& r) {
      return std::any_of(pictures.begin(), pictures.end(),
                         [&](const auto& picture) { return picture.id == r.id; });
    });
  };
  const Scanner scanner = capture.scanner.value_or(Scanner{});
  return {{"photos_used", result.photos.size()},
          {"photos_rejected", count(capture.photos)},
          {"scans_rejected", count(scanner.scans)},
          {"placements_rejected", count(scanner.placements)},
          {"reprojection_rms_px", result.reprojection_rms_px},
          {"corner_noise_px", result.corner_noise_px},
          {"lens_terms", result.lens_terms},
          {"lens_trials", LensTrialsToJson(result)},
          {"platform", result.platform_model},
          {"platform_trials", PlatformTrialsToJson(result)},
          {"rejected", RejectedToJson(rejected)}};
}

StageJob CalibJob(const Run& run) {
  return {"calib", ToJson(run.options.calib),
          Join(run.ManifestFiles(), run.PhotoFiles(), run.ScannerFiles()),
          [&run](const fs::path& folder) {
            const CalibResult result =
                CalibrateCapture(run.capture, run.options.calib, run.progress);
            SaveCalib(result, folder);
            for (const RejectedImage& r : result.rejected) {
              run.progress.Note("set aside: " + r.id + ": " + r.reason);
            }
            return CalibFigures(run.capture, result);
          }};
}

int64_t ScansOnTurntables(const ScanResult& result) {
  int64_t count = 0;
  for (const TurntableReport& t : result.turntables) count += static_cast<int64_t>(t.scans.size());
  return count;
}

double MedianSigma(const PointCloud& cloud) {
  std::vector<float> sigmas = cloud.sigma_mm;
  if (sigmas.empty()) return 0;
  const auto middle = sigmas.begin() + static_cast<std::ptrdiff_t>(sigmas.size() / 2);
  std::nth_element(sigmas.begin(), middle, sigmas.end());
  return *middle;
}

StageJob ScanJob(const Run& run) {
  std::vector<fs::path> more = {run.workspace.Stage("calib") / "cameras.json",
                                run.workspace.Stage("calib") / "poses.json"};
  if (!run.options.scan.rig.empty()) more.emplace_back(run.options.scan.rig);
  return {"scan", ToJson(run.options.scan), Join(run.ManifestFiles(), run.ScannerFiles(), more),
          [&run](const fs::path& folder) -> json {
            if (run.capture.BringsGeometry()) return {{"points", 0}, {"brought", true}};
            const CalibResult calib = LoadCalib(run.workspace.Stage("calib"));
            const ScanResult result =
                Scan(run.capture, ReadBoard(run.capture.folder / run.capture.board), calib,
                     MakeImageLoader(run.capture), run.options.scan, run.progress,
                     KnownRigOf(run.options.scan));
            SaveScan(result, folder);
            for (const std::string& line : DescribeScans(result)) run.progress.Note(line);
            std::vector<std::pair<std::string, std::string>> rejected;
            for (const ScanFailure& f : result.rejected) {
              rejected.emplace_back(f.id, f.reason);
              run.progress.Note("set aside: " + f.id + ": " + f.reason);
            }
            return {{"points", result.points.points.size()},
                    {"scans_used", result.scans.size()},
                    {"projector_rms_px", result.rig.projector_rms_px},
                    {"condition", result.rig.condition},
                    {"rig", result.rig.source == RigSource::kGiven ? "given" : "calibrated"},
                    {"projector_lens_terms", result.rig.projector_terms},
                    {"scans_on_turntables", ScansOnTurntables(result)},
                    {"registration_kept", result.registration.kept},
                    {"registration_before_mm", result.registration.before_mm},
                    {"registration_after_mm", result.registration.after_mm},
                    {"point_sigma_median_mm", MedianSigma(result.points)},
                    {"rejected", RejectedToJson(rejected)}};
          }};
}

MeshResult MakeMesh(const Run& run, const CalibResult& calib) {
  const ImageLoader photos = MakeImageLoader(run.capture);
  if (run.capture.BringsGeometry()) {
    const fs::path mesh = run.capture.folder / run.capture.mesh;
    return PrepareGivenMesh(ReadPlyMesh(mesh), calib, run.options.mesh, run.progress, photos,
                            mesh.string());
  }
  const ScanResult scan = LoadScan(run.workspace.Stage("scan"));
  return BuildMesh(scan.points, SightsOf(scan), calib, run.options.mesh, run.progress, photos,
                   (run.workspace.Stage("scan") / "points.ply").string());
}

std::string Lines(const std::vector<std::string>& lines) {
  std::string joined;
  for (const std::string& line : lines) joined += (joined.empty() ? "" : "; ") + line;
  return joined;
}

StageJob MeshJob(const Run& run) {
  std::vector<fs::path> inputs = {run.workspace.Stage("calib") / "cameras.json",
                                  run.workspace.Stage("calib") / "poses.json"};
  if (run.capture.BringsGeometry()) {
    inputs.push_back(run.capture.folder / run.capture.mesh);
  } else {
    inputs.push_back(run.workspace.Stage("scan") / "points.ply");
    inputs.push_back(run.workspace.Stage("scan") / "rig.json");
  }
  if (run.options.mesh.texture_weight > 0) inputs = Join(inputs, run.PhotoFiles());
  return {"mesh", ToJson(run.options.mesh), inputs, [&run](const fs::path& folder) -> json {
            const CalibResult calib = LoadCalib(run.workspace.Stage("calib"));
            const MeshResult result = MakeMesh(run, calib);
            SaveMesh(result, folder);
            const MeshTopology topology = ExamineTopology(result.mesh);
            return {{"vertices", result.mesh.vertices.size()},
                    {"triangles", result.mesh.triangles.size()},
                    {"closed_manifold", topology.closed},
                    {"surface_triangles", result.surface.triangles.size()},
                    {"surface_closed_manifold", ExamineTopology(result.surface).closed},
                    {"pixel_mm", result.pixel_mm},
                    {"deviation_mean_mm", result.deviation_mean_mm},
                    {"deviation_p95_mm", result.deviation_p95_mm},
                    {"deviation_max_mm", result.deviation_max_mm},
                    {"expected_samples_per_triangle", result.samples_per_triangle},
                    {"method", result.method},
                    {"method_reason", Lines(result.reasons)},
                    {"carved_points", result.carved_points},
                    {"self_intersections",
                     result.surface_self_intersections + result.mesh_self_intersections}};
          }};
}

StageJob ResampleJob(const Run& run) {
  return {"resample", WithoutMemory(ToJson(run.options.resample)),
          Join(run.ManifestFiles(), run.PhotoFiles(),
               std::vector<fs::path>{run.workspace.Stage("calib") / "cameras.json",
                                     run.workspace.Stage("calib") / "poses.json",
                                     run.workspace.Stage("mesh") / "surface.ply",
                                     run.workspace.Stage("mesh") / "mesh.ply"}),
          [&run](const fs::path& folder) -> json {
            const MeshResult mesh = LoadMesh(run.workspace.Stage("mesh"));
            const ResampleResult result =
                Resample(run.capture, LoadCalib(run.workspace.Stage("calib")), mesh.surface,
                         mesh.mesh, MakeImageLoader(run.capture), run.options.resample,
                         folder / "light_field.lfs", run.progress);
            SavePhotoGains(result.photo_ids, result.photo_gains, folder);
            return {{"exposure_spread_stops", ExposureSpreadStops(result.photo_gains)},
                    {"mean_visible_views", result.mean_visible_views},
                    {"samples_per_triangle", result.samples_per_triangle},
                    {"dense_bytes", result.dense_bytes},
                    {"unseen_triangles", result.unseen_triangles},
                    {"saturated_share", result.saturated_share},
                    {"near_edge_share", result.near_edge_share},
                    {"hidden_share", result.hidden_share},
                    {"seen_directions_share", result.seen_directions_share}};
          }};
}

StageJob EncodeJob(const Run& run) {
  return {"encode",
          WithoutMemory(ToJson(run.options.encode)),
          {run.workspace.LightFieldFile(), run.workspace.Stage("calib") / "poses.json"},
          [&run](const fs::path& folder) -> json {
            const LightField light_field = LightField::Open(run.workspace.LightFieldFile(),
                                                            ResidentFileBytes(run.options.encode));
            const CalibResult calib = LoadCalib(run.workspace.Stage("calib"));
            const EncodeResult result = Encode(
                SourceFromLightField(
                    light_field, EyesOfPhotos(calib, light_field.photo_ids(), light_field.name())),
                run.options.encode, run.progress);
            return SaveEncode(result, folder);
          }};
}

StageJob EvaluateJob(const Run& run) {
  std::vector<fs::path> test_files;
  for (const Photo& photo : run.capture.photos) {
    if (photo.split == PhotoSplit::kTest) test_files.push_back(run.capture.folder / photo.file);
  }
  return {"evaluate", json::object(),
          Join(run.ManifestFiles(), test_files,
               std::vector<fs::path>{run.workspace.Stage("calib") / "cameras.json",
                                     run.workspace.Stage("calib") / "poses.json",
                                     run.workspace.Stage("mesh") / "surface.ply",
                                     run.workspace.ModelFile()}),
          [&run](const fs::path& folder) -> json {
            const json scores = EvaluateWorkspace(run.capture, run.workspace, run.progress);
            WriteJson(scores, folder / "evaluation.json");
            return scores;
          }};
}

StageJob ReportJob(const Run& run) {
  std::vector<fs::path> inputs;
  for (const char* stage : kStages) {
    if (std::string(stage) == "report") continue;
    inputs.push_back(run.workspace.Stage(stage) / "stage.json");
    // A stage's own command may have written there since.
    for (const std::string& output : ReadStageRecord(run.workspace.folder, stage).outputs) {
      inputs.push_back(run.workspace.Stage(stage) / output);
    }
  }
  inputs.push_back(run.workspace.TruthFile());
  return {"report", json::object(), inputs, [&run](const fs::path& folder) -> json {
            WriteReport(run.capture, run.workspace, folder, run.progress);
            return json::object();
          }};
}

// What is missing is said before the first stage works for minutes.
void RequireMaterial(const Capture& capture, int last_stage) {
  if (capture.BringsGeometry()) return;
  const std::string manifest = (capture.folder / "capture.json").string();
  if (capture.board.empty()) {
    throw Error(manifest +
                ": has neither a platform (\"board\") nor its own cameras, poses and mesh");
  }
  const bool scans = capture.scanner && !capture.scanner->scans.empty();
  if (!scans && last_stage >= StageIndex("scan")) {
    throw Error(manifest +
                ": has neither scans (\"scanner\") nor its own cameras, poses and mesh, so no "
                "surface can be made; add them, or stop with --to calib");
  }
}

// The stages before the first that runs must have been through.
void RequireEarlier(const Workspace& workspace, int first_stage) {
  for (int stage = 0; stage < first_stage; ++stage) {
    ReadStageRecord(workspace.folder, kStages[stage]);
  }
}

}  // namespace

void RefreshReport(const Capture& capture, const Workspace& workspace, Progress& progress) {
  const WorkspaceLock lock(workspace.folder);
  const Run run{capture, workspace, {}, progress};
  RunOrSkip(workspace.folder, ReportJob(run), progress);
}

PipelineSummary RunPipeline(const fs::path& capture_folder, const PipelineOptions& options,
                            Progress& progress) {
  if (VariesInLight(capture_folder)) return RunLightPipeline(capture_folder, options, progress);
  const int from = StageIndex(options.from), to = StageIndex(options.to);
  if (from > to) throw Error("--from " + options.from + " lies behind --to " + options.to);
  const Run run{LoadCapture(capture_folder), {options.out}, options, progress};
  RequireMaterial(run.capture, to);
  RequireWritableFolder(run.workspace.folder);
  // A new workspace is not made only to say that nothing is in it.
  if (!fs::exists(run.workspace.folder)) RequireEarlier(run.workspace, from);
  const WorkspaceLock lock(run.workspace.folder);
  for (const char* stage : kStages) RecoverStage(run.workspace.folder, stage);
  RequireEarlier(run.workspace, from);
  // A job is described when its turn comes: by then the results that it reads are there.
  constexpr std::array<StageJob (*)(const Run&), kStages.size()> kJobs = {
      CalibJob, ScanJob, MeshJob, ResampleJob, EncodeJob, EvaluateJob, ReportJob};
  PipelineSummary summary;
  for (int stage = from; stage <= to; ++stage) {
    const StageRecord record = RunOrSkip(run.workspace.folder, kJobs[stage](run), progress);
    progress.Note(std::string(kStages[stage]) + ": " +
                  (record.skipped ? "unchanged"
                                  : std::to_string(std::lround(record.elapsed_in_seconds)) + " s"));
    summary.stages.emplace_back(kStages[stage], record);
  }
  return summary;
}

}  // namespace lfm
