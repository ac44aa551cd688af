// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "calib/board.h"
#include "core/capture.h"
#include "core/image.h"
#include "core/progress.h"
#include "core/triangle_mesh.h"
#include "sample_data/sensor.h"
#include "sample_data/studio_options.h"
#include "sample_data/studio_report.h"
#include "sample_data/studio_scene.h"

namespace lfm {

/// Takes each finished picture; `file` is relative to the capture folder. Called from many threads.
using PictureSink = std::function<void(const std::string& file, const Image& picture)>;

/// What stands under the scanner.
struct ScannedSet {
  const StudioScene& scene;  ///< the object on the plate on the table
  const TriangleMesh& mesh;  ///< the object
  const SetReflectance& reflectance;
  const Board& board;  ///< as printed
};

/// All scans and placements, as the manifests list them.
struct TakenScans {
  Camera camera;           ///< the true one
  Scanner scanner, truth;  ///< for the capture's manifest, and with geometry and poses
  StageReport report;
};

/// Takes options.scans scans of the object, painted white, and options.placements pictures of the
/// empty platform, and hands every frame to `sink` as an 8-bit gray picture; file names end in
/// `ending`. `camera_name` is the manifest's. `options` are resolved (ResolveTiny).
TakenScans TakeScans(const StudioOptions& options, const ScannedSet& set, const Sensor& sensor,
                     const std::string& camera_name, const std::string& ending,
                     const PictureSink& sink, Progress& progress);

}  // namespace lfm
