// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calib/board.h"
#include "core/capture.h"
#include "core/image.h"
#include "core/progress.h"
#include "sample_data/photo_conditions.h"
#include "sample_data/scan_session.h"
#include "sample_data/studio_options.h"
#include "sample_data/studio_report.h"
#include "sample_data/subject.h"

namespace lfm {

/// A capture and the truth about it.
struct StudioResult {
  Capture capture;    ///< the manifest; folder is empty
  Capture truth;      ///< the same with intrinsics, poses, masks and the mesh; files relative to
                      ///< the capture's folder `ground_truth`
  TriangleMesh mesh;  ///< the object as rendered, world frame, coloured by its diffuse albedo
  Board board;        ///< as designed: what capture.board describes
  Board printed;      ///< the same as printed
  std::vector<PhotoConditions> conditions;  ///< one a photograph
  StudioReport report;                      ///< rays and noise of light, photographs and scans
};

/// Builds the object, bakes its light, takes the photographs and the scans, and hands every picture
/// to `sink`: photographs (in the chosen format, with all trouble and the sensor's noise), scan and
/// placement frames (8-bit gray), and, under ground_truth/, a mask of every photograph and
/// noise-free test photographs. The noise of a baked scene is measured on up to four photographs
/// (see photo_source.h, RenderAgain), of a traced one on all. Throws Error when --mesh cannot be
/// read or options do not agree.
StudioResult RenderStudio(const StudioOptions& options, const PictureSink& sink,
                          Progress& progress);

/// Makes a whole capture folder. Every file is written under a temporary name and renamed;
/// capture.json of an earlier run is removed before the first picture and written last, so that a
/// folder with a manifest is complete. Options that cannot be followed leave no folder. Beside the
/// truth's manifest stand ground_truth/exports (exports.h), studio.json (studio_report.h; rays and
/// noise are notes to `progress`, too) and, when anything of options.trouble is not at its default,
/// trouble.json, platform.json and the printed board (docs/formats.md).
void MakeCapture(const StudioOptions& options, const std::filesystem::path& folder,
                 Progress& progress);

}  // namespace lfm
