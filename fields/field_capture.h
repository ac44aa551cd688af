// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "core/capture.h"
#include "core/image.h"
#include "core/options.h"
#include "core/progress.h"

namespace lfm {

/// What light positions of other programs do not say.
struct FieldCaptureOptions {
  int held_out_lights = 8;  ///< every so many-th light is held out; 0: none
  ColorEncoding encoding = ColorEncoding::kLinear;
  void Declare(OptionVisitor& v) {
    v.Integer(
        {"held-out-lights",
         "Of .lp files and DiLiGenT folders keep every so many-th light for scoring; 0: none.", "",
         0, 1000000},
        held_out_lights);
    v.Enumeration({"field-encoding", "What 16-bit pictures that an .lp file names hold."},
                  {"linear", "srgb"}, encoding);
  }
};

/// Whether `file` is there and an .lp file by its ending.
bool IsLpFile(const std::filesystem::path& file);
/// Those of a folder, in order of their names; none where the folder cannot be read.
std::vector<std::filesystem::path> LpFilesIn(const std::filesystem::path& folder);

/// Opens whatever holds a reflectance field or light transport as a capture: a folder with
/// capture.json (which alone states its own split and encoding), an .lp file (fields/rti_capture.h)
/// or a folder with exactly one, there or in `assembly-files`, or a folder in DiLiGenT's layout
/// (fields/diligent_capture.h). What is there is looked for in this order: capture.json, DiLiGenT,
/// .lp.
///
/// Throws Error, naming what was looked for and what to do, when `path` is none of these, holds
/// several .lp files, or its manifest has neither kind of field.
Capture OpenFieldCapture(const std::filesystem::path& path, const FieldCaptureOptions& options,
                         Progress& progress);

}  // namespace lfm
