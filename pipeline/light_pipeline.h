// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "core/options.h"
#include "core/progress.h"
#include "fields/field_capture.h"
#include "fields/field_encoding.h"
#include "fields/field_reading.h"

namespace lfm {

struct PipelineOptions;
struct PipelineSummary;

/// How captures that vary in light are read and encoded.
struct LightPipelineOptions {
  FieldCaptureOptions capture;
  FieldReadOptions read;
  FieldEncodeOptions encode;
  bool rti_files = false;

  void Declare(OptionVisitor& v) {
    capture.Declare(v);
    read.Declare(v);
    encode.Declare(v);
    v.Flag({"rti-files",
            "Also write the classic fits for RTI viewers: WORK/encode/fits.ptm, fits_lrgb.ptm and "
            "fits_NN.rti, in the picture's frame."},
           rti_files);
  }
};

/// Whether `capture` is one that varies in light: its manifest has a reflectance field and no
/// photographs, or it is an .lp file or a folder with one or in DiLiGenT's layout
/// (fields/field_capture.h). Throws Error as
/// LoadCapture does.
bool VariesInLight(const std::filesystem::path& capture);

/// Runs encode, evaluate and report for such a capture, those from `options.from` to `options.to`,
/// by the rules of RunPipeline (stages before encode have nothing to do):
///
///   encode    WORK/encode/model.lfr (fields/relightable_file.h) and encode.json
///   evaluate  WORK/evaluate/evaluation.json, pictures/: the model, the training pictures
///             themselves and the classic fits on held-out lights (fields/heldout_lights.h)
///   report    WORK/report/index.html, report.json
///
/// Without held-out lights the report says so and has no score.
PipelineSummary RunLightPipeline(const std::filesystem::path& capture,
                                 const PipelineOptions& options, Progress& progress);

}  // namespace lfm
