// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calib/calib.h"
#include "core/camera.h"
#include "core/capture.h"
#include "core/options.h"
#include "core/point_cloud.h"
#include "core/progress.h"

namespace lfm {

/// The calibrated rig: the scanner's camera and the projector as an inverse camera.
struct RigCalibration {
  Camera camera, projector;
  Pose projector_from_camera;
  double camera_rms_px = 0, projector_rms_px = 0;
  /// Condition of the adjustment's normal matrix, scaled to unit diagonal, over the projector's
  /// unknowns; what decides whether the rig's motion could calibrate it.
  double condition = 0;
};

/// Points of one scan in the world frame, in raster order of the camera's pixels.
struct ScanCloud {
  std::string id;
  PointCloud cloud;
};

struct ScanFailure {
  std::string id, reason;
};

struct ScanResult {
  RigCalibration rig;
  std::vector<ScanCloud> scans;
  PointCloud points;  ///< all scans together, outliers removed
  std::vector<ScanFailure> rejected;
};

struct ScanOptions {
  double min_contrast = 0.03;
  double min_confidence = 0.2;
  double max_ray_gap_mm = 0.5;
  double max_grazing_deg = 80;
  void Declare(OptionVisitor& v) {
    v.Number({"min-contrast", "Ignore pixels whose white and black pictures differ less (linear).",
              "", 0, 1},
             min_contrast);
    v.Number({"min-confidence", "Drop points below this confidence.", "", 0, 1}, min_confidence);
    v.Number({"max-ray-gap-mm",
              "Drop a point when neighbouring pixels disagree by more: a depth "
              "edge.",
              "mm", 0.001, 1000},
             max_ray_gap_mm);
    v.Number({"max-scan-angle-deg", "Drop points seen at more than this angle from their normal.",
              "deg", 0, 90},
             max_grazing_deg);
  }
};

/// Calibrates the rig from the tilted placements (and checks that they can: Error otherwise, never
/// a guess), decodes every scan, triangulates, and brings all points into the platform frame.
/// A scan or placement with missing or unreadable frames, or of another size than the calibrated
/// camera, is set aside with the reason. Error when no scan is left, no point survives, or the
/// roles name no column patterns (points are measured by projector columns) or patterns that Decode
/// does not read; that before any picture is loaded.
ScanResult Scan(const Capture& capture, const Board& board, const CalibResult& calib,
                const ImageLoader& load_image, const ScanOptions& options, Progress& progress);

}  // namespace lfm
