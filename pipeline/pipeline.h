// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/calib.h"
#include "core/options.h"
#include "core/progress.h"
#include "encode/encode.h"
#include "mesh/mesh.h"
#include "pipeline/light_pipeline.h"
#include "pipeline/stage_cache.h"
#include "pipeline/workspace.h"
#include "resample/resample.h"
#include "scan/scan.h"

namespace lfm {

/// How much time may be spent for quality; sets knobs of several stages together.
enum class Effort { kFast, kBalanced, kBest };

struct PipelineOptions {
  std::string out = "work";
  Effort effort = Effort::kBalanced;
  std::string from = "calib", to = "report";
  CalibOptions calib;
  ScanOptions scan;
  MeshOptions mesh;
  ResampleOptions resample;
  EncodeOptions encode;
  LightPipelineOptions light;

  void Declare(OptionVisitor& v) {
    v.Text({"out", "Workspace folder; made when absent."}, out);
    v.Enumeration(
        {"effort", "Sets the defaults of the stages' knobs: time against quality and size."},
        {"fast", "balanced", "best"}, effort);
    v.Text({"from", "First stage to run (calib, scan, mesh, resample, encode, evaluate, report)."},
           from);
    v.Text({"to", "Last stage to run."}, to);
  }
};

/// The defaults of an effort; options given by the user are laid over them.
PipelineOptions PresetOptions(Effort effort);

struct PipelineSummary {
  std::vector<std::pair<std::string, StageRecord>> stages;  ///< those in [from, to], in order
};

/// Runs the stages of `capture_folder` into `options.out`, from `from` to `to`; a stage whose
/// inputs and options are unchanged is skipped. A capture that brings cameras, poses and a mesh
/// skips calibration and scanning. A capture without test photographs gets its report too, without
/// a score. A capture that varies in light instead (VariesInLight) goes through RunLightPipeline.
/// Throws Error when a stage before `from` has not been run, when the capture lacks what a
/// stage needs, or when another run is at work in the workspace.
PipelineSummary RunPipeline(const std::filesystem::path& capture_folder,
                            const PipelineOptions& options, Progress& progress);

/// Makes the report again (after lfm-evaluate has added the truth), by the same rules of skipping.
void RefreshReport(const Capture& capture, const Workspace& workspace, Progress& progress);

}  // namespace lfm
