// SPDX-License-Identifier: BSD-3-Clause
#include "scan/scan.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "scan/consensus.h"
#include "scan/known_rig.h"
#include "scan/raster_correction.h"
#include "scan/registration.h"
#include "scan/rig_calibration.h"
#include "scan/scan_decoding.h"
#include "scan/triangulate.h"
#include "scan/world_cloud.h"

namespace lfm {
namespace {

constexpr int kPointsPerPlacement = 2000, kPointsPerScan = 600;
// Under a scan, what lies farther from where the plate would be lit is the object.
constexpr double kPlateReachPx = 2;
constexpr double kMaxPlatformOffPx = 1;
constexpr size_t kEnoughPlatePoints = 50;

/// All sets that can be used, and why the others cannot.
struct Sets {
  std::vector<DecodedSet> usable;
  std::vector<ScanFailure> failures;
};

Sets Sort(std::vector<DecodedSet> decoded) {
  Sets sets;
  for (DecodedSet& s : decoded) {
    if (s.Usable()) {
      sets.usable.push_back(std::move(s));
    } else {
      sets.failures.push_back({s.id, s.reason});
    }
  }
  return sets;
}

/// Points on the plate, and those of them that a rig confirms.
struct PlateCount {
  double asked = 0, kept = 0;
};

void AddEvidence(const DecodedSet& set, RigEvidence& evidence) {
  const int index = static_cast<int>(evidence.placements.size());
  evidence.placements.push_back(set.platform);
  for (PlateCorrespondence c : set.plate) {
    c.placement = index;
    evidence.correspondences.push_back(c);
  }
}

/// Leaves of a scan's plate points those that the start rig confirms; counts both.
void KeepPlate(const RigCalibration& rig, DecodedSet& scan, PlateCount& count) {
  count.asked += static_cast<double>(scan.plate.size());
  std::erase_if(scan.plate, [&](const PlateCorrespondence& c) {
    const Eigen::Vector3d point = MeetPlate(scan.platform.camera_from_world, c.ray, c.plate);
    const auto pixel = Project(rig.projector, rig.projector_from_camera * point);
    return !pixel || !(std::abs(pixel->x() - c.projector_px.x()) <= kPlateReachPx);
  });
  count.kept += static_cast<double>(scan.plate.size());
}

RigAgreement AgreementOf(const PlateCount& count, const RigRefinement& refined) {
  std::vector<double> medians;
  for (double m : refined.median_px) {
    if (m > 0) medians.push_back(m);
  }
  std::sort(medians.begin(), medians.end());
  RigAgreement agreement;
  agreement.points = static_cast<int>(count.asked);
  agreement.share = count.asked > 0 ? count.kept / count.asked : 0;
  agreement.median_px = medians.empty() ? 0 : medians[medians.size() / 2];
  return agreement;
}

std::string PlatformOff(double median_px) {
  char text[200];
  std::snprintf(text, sizeof text,
                "its platform lies %.1f projector pixels from where the rig's other pictures put "
                "it; it moved between frames?",
                median_px);
  return text;
}

/// The usable scans that agree with the adjusted rig, with their poses.
struct StandingScans {
  std::vector<DecodedSet> sets;
  std::vector<PoseEstimate> poses;
};

StandingScans KeepStanding(std::vector<DecodedSet> sets, const RigRefinement& refined,
                           size_t scans_begin, std::vector<ScanFailure>& failures) {
  StandingScans standing;
  for (size_t i = 0; i < sets.size(); ++i) {
    const double off = refined.median_px[scans_begin + i];
    if (off > kMaxPlatformOffPx && sets[i].plate.size() >= kEnoughPlatePoints) {
      failures.push_back({sets[i].id, PlatformOff(off)});
      continue;
    }
    standing.sets.push_back(std::move(sets[i]));
    standing.poses.push_back(refined.platforms[scans_begin + i]);
  }
  return standing;
}

std::vector<TurntableReport> ReportRuns(const std::vector<TurntableRun>& runs,
                                        const std::vector<DecodedSet>& scans, size_t scans_begin) {
  std::vector<TurntableReport> reports;
  for (const TurntableRun& run : runs) {
    TurntableReport report{{}, run.direction, run.point, run.rms_mm, run.chi2_per_dof};
    for (int m : run.members) {
      report.scans.push_back(scans[static_cast<size_t>(m) - scans_begin].id);
    }
    reports.push_back(report);
  }
  return reports;
}

RigCalibration Calibrated(const Capture& capture, const Camera& camera, const Sets& placements,
                          const RigCalibrationOptions& options) {
  RigEvidence evidence;
  for (const DecodedSet& s : placements.usable) AddEvidence(s, evidence);
  return CalibrateRig(camera, capture.scanner->projector_width, capture.scanner->projector_height,
                      evidence.placements, evidence.correspondences, options)
      .rig;
}

/// How sharp the projector's pixels are where it lights the plate.
double RasterGain(const RigCalibration& rig, const Sets& sets) {
  RigEvidence evidence;
  for (const DecodedSet& s : sets.usable) AddEvidence(s, evidence);
  RigState state{rig.camera, rig.projector, rig.projector_from_camera, {}};
  for (const PlatePlacement& p : evidence.placements)
    state.platforms.push_back(p.camera_from_world);
  return FitRasterGain(state, evidence.correspondences);
}

void RemoveRaster(double gain, Sets& sets) {
  for (DecodedSet& s : sets.usable) {
    s.plate = CorrectRaster(std::move(s.plate), gain);
    if (s.pixels.column.position.empty()) continue;
    s.pixels.column =
        CorrectRaster(std::move(s.pixels.column), s.pixels.width, s.pixels.height, gain);
  }
}

/// Why placements cannot be used is what their owner can mend.
[[noreturn]] void ThrowNoRig(size_t asked, const Sets& placements) {
  const ScanFailure& example = placements.failures.front();
  throw Error("the rig cannot be calibrated: only " + std::to_string(placements.usable.size()) +
              " of " + std::to_string(asked) +
              " placements of the empty platform can be used, at least two are needed; for one, " +
              example.id + ": " + example.reason);
}

/// The rig to start from: the known one, or one calibrated on the placements alone; then once more
/// without the projector's raster.
RigCalibration StartRig(const Capture& capture, const Camera& camera,
                        const std::optional<KnownRig>& known, Sets& placements) {
  constexpr size_t kFewestPlacements = 2;
  if (!known && placements.usable.size() < kFewestPlacements && !placements.failures.empty()) {
    ThrowNoRig(capture.scanner->placements.size(), placements);
  }
  // Which lens terms the projector needs is asked once, without the raster.
  RigCalibration rig = known ? RigFromKnown(*known, capture)
                             : Calibrated(capture, camera, placements, {.lens_terms = 4});
  const double gain = RasterGain(rig, placements);
  RemoveRaster(gain, placements);
  if (!known) rig = Calibrated(capture, camera, placements, {});
  rig.raster_gain = gain;
  return rig;
}

/// Lens terms of the scanner's camera that the adjustment may move; none where there is no corner
/// to say so, or the intrinsics were given.
std::optional<int> FreeCameraTerms(const CalibResult& calib, const std::string& camera,
                                   const std::optional<KnownRig>& known,
                                   const RigEvidence& evidence) {
  const auto terms = calib.lens_terms.find(camera);
  if (known || terms == calib.lens_terms.end()) return std::nullopt;
  for (const PlatePlacement& p : evidence.placements) {
    if (p.corners.empty()) return std::nullopt;
  }
  return terms->second;
}

std::vector<PosedRange> TriangulateAll(const RigRefinement& refined,
                                       const std::vector<Eigen::Vector2d>& rays,
                                       StandingScans& scans, const ScanOptions& options,
                                       Progress& progress) {
  std::vector<PosedRange> ranges(scans.sets.size());
  progress.Start("triangulate", static_cast<int64_t>(ranges.size()));
  ParallelFor(0, static_cast<int64_t>(ranges.size()), [&](int64_t i) {
    const size_t k = static_cast<size_t>(i);
    ranges[k] = {Triangulate(refined.rig, rays, scans.sets[k].pixels, options, refined.uncertainty),
                 scans.poses[k].camera_from_world};
    scans.sets[k].pixels = {};
    progress.Advance();
  });
  return ranges;
}

RegistrationReport RefinePoses(const RigCalibration& rig, const std::vector<Eigen::Vector2d>& rays,
                               const StandingScans& scans, std::vector<PosedRange>& ranges,
                               Progress& progress) {
  std::vector<Eigen::Matrix<double, 6, 6>> covariances;
  for (const PoseEstimate& p : scans.poses) covariances.push_back(p.covariance);
  const Registration registered =
      RegisterScans(ranges, covariances, rig.camera, rays, {}, progress);
  for (size_t i = 0; i < ranges.size(); ++i) ranges[i].camera_from_world = registered.poses[i];
  return registered.report;
}

void RequireScanner(const Capture& capture, const CalibResult& calib, bool rig_known) {
  if (!capture.scanner) {
    throw Error("capture \"" + capture.name + "\" has no scanner; add one to capture.json");
  }
  const Scanner& scanner = *capture.scanner;
  if (!calib.cameras.contains(scanner.camera)) {
    throw Error("the calibration lacks the scanner's camera \"" + scanner.camera +
                "\"; run lfm-calib again");
  }
  if (!rig_known) RequireSameSize(capture, calib.cameras.at(scanner.camera));
  if (scanner.scans.empty()) throw Error("the capture has a scanner but no scans of the object");
  if (scanner.placements.empty() && !rig_known) {
    throw Error(
        "the capture has no placements of the empty platform, and without them the rig cannot be "
        "calibrated; scan it at least twice, tilted in different directions, under column and row "
        "patterns, or give a known rig");
  }
}

/// Everything that was decoded, and the rig to start from.
struct Decoded {
  Sets placements, scans;
  RigCalibration start;
};

Decoded DecodeAll(const Capture& capture, const std::optional<KnownRig>& known, DecodingTask task,
                  Progress& progress) {
  const Scanner& scanner = *capture.scanner;
  const PatternSequence scan_sequence = RequireColumns(capture, scanner.scan_roles, "scan_roles");
  Decoded decoded;
  if (!scanner.placements.empty()) {
    const PatternSequence sequence =
        RequireColumns(capture, scanner.placement_roles, "placement_roles");
    progress.Start("decode placements", static_cast<int64_t>(scanner.placements.size() *
                                                             scanner.placement_roles.size()));
    task.sequence = &sequence;
    task.plate_points = kPointsPerPlacement;
    decoded.placements =
        Sort(DecodeSets(scanner.placements, task.calib.placements, task, progress));
  }
  decoded.start = StartRig(capture, task.camera, known, decoded.placements);
  progress.Start("decode scans",
                 static_cast<int64_t>(scanner.scans.size() * scanner.scan_roles.size()));
  task.sequence = &scan_sequence;
  task.plate_points = kPointsPerScan;
  decoded.scans = Sort(DecodeSets(scanner.scans, task.calib.scans, task, progress));
  double& gain = decoded.start.raster_gain;
  if (scanner.placements.empty()) gain = RasterGain(decoded.start, decoded.scans);
  RemoveRaster(gain, decoded.scans);
  return decoded;
}

/// The scans' clouds; those without a point join the failures.
std::vector<ScanCloud> MakeClouds(std::vector<PosedRange> ranges, const StandingScans& scans,
                                  const std::vector<Eigen::Vector2d>& rays, const Board& board,
                                  std::vector<ScanFailure>& failures) {
  std::vector<ScanCloud> clouds;
  for (size_t i = 0; i < ranges.size(); ++i) {
    PointCloud cloud = CloudFromRange(ranges[i], scans.poses[i].covariance, rays, board);
    ranges[i].map = {};
    if (cloud.points.empty()) {
      failures.push_back({scans.sets[i].id, kNothingAbovePlate});
      continue;
    }
    clouds.push_back({scans.sets[i].id, std::move(cloud), ranges[i].camera_from_world});
  }
  return clouds;
}

/// A failed scan's reason is the last thing that the list of failures got.
[[noreturn]] void ThrowNoScan(size_t asked, const ScanFailure& example) {
  throw Error("none of the " + std::to_string(asked) + " scans can be used; for one, " +
              example.id + ": " + example.reason);
}

/// RMS of the corners that calibration found in the scanner's pictures.
double CameraRms(const CalibResult& calib) {
  double sum = 0, count = 0;
  for (const auto* poses : {&calib.scans, &calib.placements}) {
    for (const PosedImage& p : *poses) {
      sum += p.corners * p.reprojection_rms_px * p.reprojection_rms_px;
      count += p.corners;
    }
  }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

}  // namespace

ScanResult Scan(const Capture& capture, const Board& board, const CalibResult& calib,
                const ImageLoader& load_image, const ScanOptions& options, Progress& progress,
                const std::optional<KnownRig>& given) {
  std::optional<KnownRig> known = given;
  if (!known && capture.scanner && calib.cameras.contains(capture.scanner->camera)) {
    known = RigOfManifest(capture, calib.cameras.at(capture.scanner->camera));
  }
  RequireScanner(capture, calib, known.has_value());
  const Scanner& scanner = *capture.scanner;
  if (known) RigFromKnown(*known, capture);  // says what does not fit before any picture is read
  const Camera& camera = known ? known->camera : calib.cameras.at(scanner.camera);
  const std::vector<Eigen::Vector2d> start_rays = NormalizedRays(camera);
  Decoded decoded =
      DecodeAll(capture, known, {board, calib, camera, start_rays, load_image, options}, progress);
  ScanResult result;
  result.rejected = decoded.placements.failures;
  result.rejected.insert(result.rejected.end(), decoded.scans.failures.begin(),
                         decoded.scans.failures.end());
  if (decoded.scans.usable.empty()) ThrowNoScan(scanner.scans.size(), result.rejected.back());

  RigEvidence evidence;
  PlateCount count;
  for (DecodedSet& s : decoded.placements.usable) {
    if (known) KeepPlate(decoded.start, s, count);
    AddEvidence(s, evidence);
  }
  const size_t scans_begin = evidence.placements.size();
  for (DecodedSet& s : decoded.scans.usable) {
    KeepPlate(decoded.start, s, count);
    AddEvidence(s, evidence);
  }
  progress.Start("adjust rig", 1);
  const RigRefinement refined =
      RefineRig(decoded.start, FreeCameraTerms(calib, scanner.camera, known, evidence), evidence,
                static_cast<int>(scans_begin), options.turntable, {});
  if (known) RequireAgreement(AgreementOf(count, refined), *known);
  result.rig = refined.rig;
  if (result.rig.camera_rms_px == 0) result.rig.camera_rms_px = CameraRms(calib);
  result.turntables = ReportRuns(refined.runs, decoded.scans.usable, scans_begin);

  const std::vector<Eigen::Vector2d> rays = NormalizedRays(result.rig.camera);
  StandingScans standing =
      KeepStanding(std::move(decoded.scans.usable), refined, scans_begin, result.rejected);
  std::vector<PosedRange> ranges = TriangulateAll(refined, rays, standing, options, progress);
  if (options.registration == RegistrationUse::kAuto) {
    result.registration = RefinePoses(result.rig, rays, standing, ranges, progress);
  }
  ranges = KeepConsensus(std::move(ranges), result.rig.camera, rays,
                         ConsensusWithin(options.agreement_mm_per_m * 1e-3));
  result.scans = MakeClouds(std::move(ranges), standing, rays, board, result.rejected);
  if (result.scans.empty()) ThrowNoScan(scanner.scans.size(), result.rejected.back());
  result.points = Concatenate(result.scans);
  return result;
}

}  // namespace lfm
