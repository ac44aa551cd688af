// SPDX-License-Identifier: BSD-3-Clause
#include "scan/scan.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "scan/consensus.h"
#include "scan/decode.h"
#include "scan/patterns.h"
#include "scan/rig_calibration.h"
#include "scan/triangulate.h"

namespace lfm {
namespace {

constexpr int kPointsPerPlacement = 2000;
// Nearer to the plate than this, a point is the plate's: paper and ink scatter by about half of it.
constexpr double kPlateMm = 0.4;

/// One decoded set of frames, or why there is none.
struct DecodedSet {
  const ScanSet* set = nullptr;
  const PosedImage* pose = nullptr;
  std::optional<DecodedPixels> pixels;
  std::string reason;
};

const PosedImage* FindPose(const std::vector<PosedImage>& poses, const std::string& id) {
  const auto found =
      std::find_if(poses.begin(), poses.end(), [&](const PosedImage& p) { return p.id == id; });
  return found == poses.end() ? nullptr : &*found;
}

std::string WhyNoPose(const CalibResult& calib, const ScanSet& set) {
  for (const RejectedImage& r : calib.rejected) {
    // A photograph may have the same id; its file is another.
    const bool own = std::find(set.frames.begin(), set.frames.end(), r.file) != set.frames.end();
    if (own && r.id == set.id) return "calibration found no pose of the platform: " + r.reason;
  }
  return "calibration has no pose of the platform for it; run lfm-calib again";
}

/// Decodes sets in parallel; what a set lacks is its own misfortune, an interrupt everybody's.
std::vector<DecodedSet> DecodeSets(const std::vector<ScanSet>& sets,
                                   const std::vector<PosedImage>& poses, const CalibResult& calib,
                                   const PatternSequence& sequence, const ImageLoader& load_image,
                                   const ScanOptions& options, Progress& progress) {
  std::vector<DecodedSet> decoded(sets.size());
  DecodeOptions decode_options;
  decode_options.min_contrast = options.min_contrast;
  ParallelFor(0, static_cast<int64_t>(sets.size()), [&](int64_t i) {
    const ScanSet& set = sets[static_cast<size_t>(i)];
    DecodedSet& out = decoded[static_cast<size_t>(i)];
    out.set = &set;
    out.pose = FindPose(poses, set.id);
    if (out.pose == nullptr) {
      out.reason = WhyNoPose(calib, set);
      progress.Advance(static_cast<int64_t>(set.frames.size()));
      return;
    }
    int64_t read = 0;
    try {
      if (set.frames.size() != sequence.patterns.size()) {
        throw Error("it has " + std::to_string(set.frames.size()) + " frames, its roles are " +
                    std::to_string(sequence.patterns.size()));
      }
      const FrameLoader load = [&](int index) {
        progress.Advance();
        ++read;
        return load_image(set.frames[static_cast<size_t>(index)]);
      };
      out.pixels = Decode(sequence, load, decode_options);
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::kSystem) throw;
      out.reason = error.what();
      progress.Advance(std::max<int64_t>(0, static_cast<int64_t>(set.frames.size()) - read));
    }
  });
  return decoded;
}

std::vector<ScanFailure> Failures(const std::vector<DecodedSet>& sets) {
  std::vector<ScanFailure> failures;
  for (const DecodedSet& s : sets) {
    if (!s.pixels) failures.push_back({s.set->id, s.reason});
  }
  return failures;
}

/// Sets aside what was taken in another size than the calibration saw.
void RequireSizeOf(const Camera& camera, std::vector<DecodedSet>& sets) {
  for (DecodedSet& s : sets) {
    if (!s.pixels || (s.pixels->width == camera.width && s.pixels->height == camera.height)) {
      continue;
    }
    s.reason = "its pictures have " + std::to_string(s.pixels->width) + " x " +
               std::to_string(s.pixels->height) + " pixels, the calibrated camera " +
               std::to_string(camera.width) + " x " + std::to_string(camera.height);
    s.pixels.reset();
  }
}

PatternSequence RequireColumns(const Capture& capture, const std::vector<std::string>& roles,
                               const char* key) {
  const Scanner& scanner = *capture.scanner;
  const PatternSequence sequence =
      SequenceFromNames(scanner.projector_width, scanner.projector_height, roles);
  RequireComplete(sequence);
  const bool columns =
      std::any_of(sequence.patterns.begin(), sequence.patterns.end(), [](const Pattern& pattern) {
        return pattern.kind != PatternKind::kWhite && pattern.kind != PatternKind::kBlack &&
               pattern.axis == PatternAxis::kColumn;
      });
  if (!columns) {
    throw Error((capture.folder / "capture.json").string() + ": scanner." + key +
                ": names no column patterns (\"column-gray-0\", ...), and points are measured by "
                "projector columns; scan with them");
  }
  return sequence;
}

RigCalibration CalibrateFromPlacements(const Scanner& scanner, const Camera& camera,
                                       const Board& board, const std::vector<Eigen::Vector2d>& rays,
                                       const std::vector<DecodedSet>& sets) {
  std::vector<PlatePlacement> placements;
  std::vector<PlateCorrespondence> correspondences;
  for (const DecodedSet& s : sets) {
    if (!s.pixels) continue;
    placements.push_back({s.pose->camera_from_world, s.pose->covariance});
    const std::vector<PlateCorrespondence> found =
        PlateCorrespondences(*s.pixels, rays, board, placements.back(),
                             static_cast<int>(placements.size()) - 1, kPointsPerPlacement);
    correspondences.insert(correspondences.end(), found.begin(), found.end());
  }
  return CalibrateRig(camera, scanner.projector_width, scanner.projector_height, placements,
                      correspondences, {})
      .rig;
}

/// RMS over the pictures of the rig's camera, each weighing as many corners as it has.
double CameraRms(const CalibResult& calib) {
  double sum = 0, corners = 0;
  for (const auto* poses : {&calib.scans, &calib.placements}) {
    for (const PosedImage& p : *poses) {
      sum += p.corners * p.reprojection_rms_px * p.reprojection_rms_px;
      corners += p.corners;
    }
  }
  return corners > 0 ? std::sqrt(sum / corners) : 0;
}

bool OnPlate(const Eigen::Vector3d& point, const Board& board) {
  return std::abs(point.x()) <= board.width_mm / 2 && std::abs(point.y()) <= board.height_mm / 2;
}

/// Points that stand on the plate, in the world, in raster order.
PointCloud CloudFromRange(const PosedRange& scan, const std::vector<Eigen::Vector2d>& rays,
                          const Board& board) {
  PointCloud cloud;
  const Pose world_from_camera = scan.camera_from_world.Inverse();
  for (size_t p = 0; p < scan.map.depth.size(); ++p) {
    if (scan.map.depth[p] <= 0) continue;
    const Eigen::Vector3d point = world_from_camera * (scan.map.depth[p] * rays[p].homogeneous());
    if (point.z() < kPlateMm || !OnPlate(point, board)) continue;
    cloud.points.push_back(point);
    cloud.normals.push_back(world_from_camera.rotation * scan.map.normal[p].cast<double>());
    cloud.confidence.push_back(scan.map.confidence[p]);
  }
  return cloud;
}

void Append(const PointCloud& part, PointCloud& whole) {
  whole.points.insert(whole.points.end(), part.points.begin(), part.points.end());
  whole.normals.insert(whole.normals.end(), part.normals.begin(), part.normals.end());
  whole.confidence.insert(whole.confidence.end(), part.confidence.begin(), part.confidence.end());
}

std::vector<PosedRange> TriangulateAll(const RigCalibration& rig,
                                       const std::vector<Eigen::Vector2d>& rays,
                                       const std::vector<const DecodedSet*>& sets,
                                       const ScanOptions& options, Progress& progress) {
  std::vector<PosedRange> ranges(sets.size());
  ParallelFor(0, static_cast<int64_t>(sets.size()), [&](int64_t i) {
    const DecodedSet& set = *sets[static_cast<size_t>(i)];
    ranges[static_cast<size_t>(i)] = {Triangulate(rig, rays, *set.pixels, options),
                                      set.pose->camera_from_world};
    progress.Advance();
  });
  return ranges;
}

}  // namespace

ScanResult Scan(const Capture& capture, const Board& board, const CalibResult& calib,
                const ImageLoader& load_image, const ScanOptions& options, Progress& progress) {
  if (!capture.scanner) {
    throw Error("capture \"" + capture.name + "\" has no scanner; add one to capture.json");
  }
  const Scanner& scanner = *capture.scanner;
  const auto camera = calib.cameras.find(scanner.camera);
  if (camera == calib.cameras.end()) {
    throw Error("the calibration lacks the scanner's camera \"" + scanner.camera +
                "\"; run lfm-calib again");
  }
  if (scanner.scans.empty()) throw Error("the capture has a scanner but no scans of the object");
  if (scanner.placements.empty()) {
    throw Error(
        "the capture has no placements of the empty platform, and without them the rig cannot be "
        "calibrated; scan it at least twice, tilted in different directions, under column and row "
        "patterns");
  }
  const std::vector<Eigen::Vector2d> rays = NormalizedRays(camera->second);

  const PatternSequence placement_sequence =
      RequireColumns(capture, scanner.placement_roles, "placement_roles");
  const PatternSequence scan_sequence = RequireColumns(capture, scanner.scan_roles, "scan_roles");
  progress.Start("decode placements",
                 static_cast<int64_t>(scanner.placements.size() * scanner.placement_roles.size()));
  ScanResult result;
  {
    std::vector<DecodedSet> placements =
        DecodeSets(scanner.placements, calib.placements, calib, placement_sequence, load_image,
                   options, progress);
    RequireSizeOf(camera->second, placements);
    result.rejected = Failures(placements);
    result.rig = CalibrateFromPlacements(scanner, camera->second, board, rays, placements);
  }
  result.rig.camera_rms_px = CameraRms(calib);

  progress.Start("decode scans",
                 static_cast<int64_t>(scanner.scans.size() * scanner.scan_roles.size()));
  std::vector<DecodedSet> scans =
      DecodeSets(scanner.scans, calib.scans, calib, scan_sequence, load_image, options, progress);
  RequireSizeOf(camera->second, scans);
  std::vector<const DecodedSet*> good;
  for (const DecodedSet& s : scans) {
    if (s.pixels) good.push_back(&s);
  }
  const std::vector<ScanFailure> failures = Failures(scans);
  result.rejected.insert(result.rejected.end(), failures.begin(), failures.end());
  if (good.empty()) {
    throw Error("none of the " + std::to_string(scans.size()) + " scans can be used; the first (" +
                failures.front().id + "): " + failures.front().reason);
  }

  progress.Start("triangulate", static_cast<int64_t>(good.size()));
  const std::vector<PosedRange> ranges =
      KeepConsensus(TriangulateAll(result.rig, rays, good, options, progress), camera->second, rays,
                    ConsensusOptions{});
  for (size_t i = 0; i < good.size(); ++i) {
    result.scans.push_back({good[i]->set->id, CloudFromRange(ranges[i], rays, board)});
    Append(result.scans.back().cloud, result.points);
  }
  if (result.points.points.empty()) {
    throw Error(
        "the scans show no point above the platform; is the object on it, painted matt white, and "
        "inside the view of both camera and projector?");
  }
  return result;
}

}  // namespace lfm
