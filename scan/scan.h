// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calib/calib.h"
#include "core/camera.h"
#include "core/capture.h"
#include "core/options.h"
#include "core/point_cloud.h"
#include "core/progress.h"

namespace lfm {

/// Where a rig's numbers come from.
enum class RigSource {
  kPlacements,  ///< calibrated from placements of the empty platform
  kGiven,       ///< known beforehand, and checked against the scans
};

/// The calibrated rig: the scanner's camera and the projector as an inverse camera.
struct RigCalibration {
  Camera camera, projector;
  Pose projector_from_camera;
  double camera_rms_px = 0, projector_rms_px = 0;
  /// Condition of the adjustment's normal matrix, scaled to unit diagonal, over the projector's
  /// unknowns; what decides whether the rig's motion could calibrate it.
  double condition = 0;
  int projector_terms = 0;  ///< how many of k1, k2, p1, p2 the projector's lens needed
  RigSource source = RigSource::kPlacements;
  /// How sharp the projector's pixels are on the plate: 1 square, 0 smooth
  /// (`scan/raster_correction.h`).
  double raster_gain = 0;
};

/// Points of one scan in the world frame, in raster order of the camera's pixels.
struct ScanCloud {
  std::string id;
  PointCloud cloud;
  Pose camera_from_world;  ///< where the scan stands, after all adjustments
};

/// What is asked of a turntable.
enum class TurntableUse {
  kOff,   ///< poses stand for themselves
  kAuto,  ///< scans about one axis hold each other where their poses support it
  kOn,    ///< runs are looked for generously, and hold
};

/// Scans between which the platform turned about one axis.
struct TurntableReport {
  std::vector<std::string> scans;
  Eigen::Vector3d direction = {0, 0, 1}, point = {0, 0, 0};  ///< the axis, camera frame
  double rms_mm = 0;        ///< of the platforms' origins from where the axis puts them
  double chi2_per_dof = 0;  ///< of the poses against the axis
};

enum class RegistrationUse { kOff, kAuto };

/// What came of refining the scans' poses on each other (`scan/registration.h`).
struct RegistrationReport {
  bool kept = false;  ///< the refined poses are in use
  int pairs = 0;      ///< of scans that overlap
  int correspondences = 0, held_out = 0;
  /// RMS distance (mm, each at most 1) of held-out points from the other scans' surfaces, with the
  /// poses from the platform and with the refined ones.
  double before_mm = 0, after_mm = 0;
  double largest_shift_mm = 0;  ///< of the scans' middle, by the refinement
};

struct ScanFailure {
  std::string id, reason;
};

struct ScanResult {
  RigCalibration rig;
  std::vector<ScanCloud> scans;
  PointCloud points;  ///< all scans together, outliers removed
  std::vector<TurntableReport> turntables;
  RegistrationReport registration;
  std::vector<ScanFailure> rejected;
};

struct ScanOptions {
  double min_contrast = 0.03;
  double min_confidence = 0.03;
  double max_ray_gap_mm = 0.5;
  double max_grazing_deg = 88;
  double agreement_mm_per_m = 0.76;
  std::string rig;  ///< read by the commands (`KnownRigOf`), not by Scan
  TurntableUse turntable = TurntableUse::kAuto;
  RegistrationUse registration = RegistrationUse::kAuto;
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
    v.Number({"agreement",
              "Another scan confirms a point that its surface passes this near; the limits of "
              "contradiction go along.",
              "mm per m of distance", 0.001, 1000},
             agreement_mm_per_m);
    v.Text({"rig",
            "A known rig (a rig.json) to use in place of calibrating one; checked against the "
            "scans."},
           rig);
    v.Enumeration({"turntable",
                   "Whether scans about one axis hold each other: never, where their poses support "
                   "it, always."},
                  {"off", "auto", "on"}, turntable);
    v.Enumeration(
        {"registration", "Whether scans are refined on each other; the better poses are kept."},
        {"off", "auto"}, registration);
  }
};

/// A rig known before the scans were taken.
struct KnownRig {
  Camera camera, projector;
  Pose projector_from_camera;
  std::string source;  ///< for messages: the file that it came from
};

/// Calibrates the rig from the tilted placements (and checks that they can: Error otherwise, never
/// a guess) or takes the `known` one, decodes every scan, adjusts camera, projector and all poses
/// of the platform together, triangulates, refines the scans' poses on each other where that
/// improves held-out points, and brings all points into the platform frame.
///
/// Without `known`, a projector and projector_from_camera in the capture's manifest are the known
/// rig. A known rig is held and checked on what the projector shows on the platform: Error when the
/// median residual there exceeds half a projector pixel, or hardly any point agrees.
///
/// A scan or placement with missing or unreadable frames, of another size than the calibrated
/// camera, without decodable pixels (dark, saturated) or without a point above the platform, or
/// whose platform lies more than a projector pixel off, is set aside with the reason. Error when no
/// scan is left, or the roles name no column patterns (points are measured by projector columns) or
/// patterns that Decode does not read; that before any picture is loaded.
ScanResult Scan(const Capture& capture, const Board& board, const CalibResult& calib,
                const ImageLoader& load_image, const ScanOptions& options, Progress& progress,
                const std::optional<KnownRig>& known = std::nullopt);

}  // namespace lfm
