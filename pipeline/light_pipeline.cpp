// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/light_pipeline.h"

#include <array>
#include <cmath>
#include <system_error>

#include "core/error.h"
#include "core/json_reader.h"
#include "core/output_folder.h"
#include "fields/diligent_capture.h"
#include "fields/field_capture.h"
#include "fields/light_methods.h"
#include "fields/ptm_file.h"
#include "fields/relightable_file.h"
#include "fields/rti_file.h"
#include "pipeline/light_evaluation.h"
#include "pipeline/light_report.h"
#include "pipeline/pipeline.h"
#include "pipeline/workspace_lock.h"

namespace lfm {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

// Whatever says what the capture is, beside its pictures.
std::vector<fs::path> ManifestFiles(const fs::path& capture) {
  if (IsLpFile(capture)) return {capture};
  std::vector<fs::path> files;
  for (const char* name : {"capture.json", "filenames.txt", "light_directions.txt",
                           "light_intensities.txt", "mask.png"}) {
    if (fs::exists(capture / name)) files.push_back(capture / name);
  }
  for (const fs::path& folder : {capture, capture / "assembly-files"}) {
    for (const fs::path& file : LpFilesIn(folder)) files.push_back(file);
  }
  return files;
}

// Everything that the jobs of one run share.
struct Run {
  fs::path path;
  Capture capture;
  Workspace workspace;
  LightPipelineOptions options;
  Progress& progress;

  std::vector<fs::path> Inputs() const {
    std::vector<fs::path> files = ManifestFiles(path);
    const ReflectanceField& field = *capture.reflectance_field;
    if (!field.mask.empty()) files.push_back(capture.folder / field.mask);
    for (const LitPicture& picture : field.pictures) {
      files.push_back(capture.folder / picture.file);
    }
    return files;
  }
  ReflectanceFieldData Read() const {
    return ReadReflectanceField(capture, options.read, progress);
  }
};

json ToJson(LightPipelineOptions options) { return OptionsToJson(AnyOptions(options)); }

void WriteRtiFiles(const ReflectanceFieldData& data, const fs::path& folder) {
  const LightFrame frame =
      data.camera_from_world ? ViewFrame(*data.camera_from_world) : LightFrame();
  const ClassicFits fits = FitClassics(data.train, frame);
  for (const QuantizedFit& fit : fits.fits) {
    const FitPicture picture{data.train.width, data.train.height, fit};
    if (fit.basis != LightBasis::kPolynomial) {
      WriteRti(picture, folder / ("fits_" + std::to_string(LightBasisTerms(fit.basis)) + ".rti"));
    } else {
      WritePtm(picture, folder / (fit.chroma.empty() ? "fits.ptm" : "fits_lrgb.ptm"));
    }
  }
}

StageJob EncodeJob(const Run& run) {
  return {"encode", ToJson(run.options), run.Inputs(), [&run](const fs::path& folder) -> json {
            const ReflectanceFieldData data = run.Read();
            const FieldEncodeResult result =
                EncodeField(data.train, run.options.encode, run.progress);
            WriteRelightable(result.model, folder / "model.lfr");
            WriteJson(result.figures, folder / "encode.json");
            if (run.options.rti_files) WriteRtiFiles(data, folder);
            return result.figures;
          }};
}

StageJob EvaluateJob(const Run& run) {
  std::vector<fs::path> inputs = run.Inputs();
  inputs.push_back(run.workspace.RelightableFile());
  LightPipelineOptions reading;  // what the model was made with, the model tells
  reading.capture = run.options.capture;
  reading.read = run.options.read;
  return {"evaluate", ToJson(reading), inputs, [&run](const fs::path& folder) -> json {
            const json figures =
                EvaluateLights(run.Read(), ReadRelightable(run.workspace.RelightableFile()),
                               folder / "pictures", run.progress);
            WriteJson(figures, folder / "evaluation.json");
            return figures;
          }};
}

StageJob ReportJob(const Run& run) {
  std::vector<fs::path> inputs = {run.workspace.RelightableFile()};
  for (const char* stage : {"encode", "evaluate"}) {
    inputs.push_back(run.workspace.Stage(stage) / "stage.json");
    // A stage's own command may have written there since.
    for (const std::string& output : ReadStageRecord(run.workspace.folder, stage).outputs) {
      inputs.push_back(run.workspace.Stage(stage) / output);
    }
  }
  return {"report", json::object(), inputs, [&run](const fs::path& folder) -> json {
            WriteLightReport(run.capture, run.workspace, folder);
            return json::object();
          }};
}

}  // namespace

bool VariesInLight(const fs::path& capture) {
  if (IsLpFile(capture)) return true;
  std::error_code absent;
  if (fs::exists(capture / "capture.json", absent)) {
    const Capture loaded = LoadCapture(capture);
    return loaded.reflectance_field && loaded.photos.empty();
  }
  return IsDiligentFolder(capture) || !LpFilesIn(capture).empty() ||
         !LpFilesIn(capture / "assembly-files").empty();
}

PipelineSummary RunLightPipeline(const fs::path& capture, const PipelineOptions& options,
                                 Progress& progress) {
  const int from = StageIndex(options.from), to = StageIndex(options.to);
  if (from > to) throw Error("--from " + options.from + " lies behind --to " + options.to);
  if (to < StageIndex("encode")) {
    throw Error(capture.string() +
                ": varies in light alone, so nothing is done before encode; "
                "take --to encode or a later stage");
  }
  const Run run{capture,
                OpenFieldCapture(capture, options.light.capture, progress),
                {options.out},
                options.light,
                progress};
  RequireWritableFolder(run.workspace.folder);
  const std::array<std::pair<const char*, StageJob (*)(const Run&)>, 3> jobs = {
      {{"encode", EncodeJob}, {"evaluate", EvaluateJob}, {"report", ReportJob}}};
  const auto require_earlier = [&] {
    for (const auto& [stage, job] : jobs) {
      if (StageIndex(stage) < from) ReadStageRecord(run.workspace.folder, stage);
    }
  };
  // A new workspace is not made only to say that nothing is in it.
  if (!fs::exists(run.workspace.folder)) require_earlier();
  const WorkspaceLock lock(run.workspace.folder);
  for (const auto& [stage, job] : jobs) RecoverStage(run.workspace.folder, stage);
  require_earlier();
  PipelineSummary summary;
  for (const auto& [stage, job] : jobs) {
    if (StageIndex(stage) < from || StageIndex(stage) > to) continue;
    const StageRecord record = RunOrSkip(run.workspace.folder, job(run), progress);
    progress.Note(std::string(stage) + ": " +
                  (record.skipped ? "unchanged"
                                  : std::to_string(std::lround(record.elapsed_in_seconds)) + " s"));
    summary.stages.emplace_back(stage, record);
  }
  return summary;
}

}  // namespace lfm
