// SPDX-License-Identifier: BSD-3-Clause
#include "scan/scan_decoding.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "scan/frame_planes.h"

namespace lfm {
namespace {

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

std::string Size(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

/// Why not a single pixel could be decoded; empty when one could.
std::string WhyNothing(const DecodedPixels& decoded, const ScanOptions& options) {
  const auto& confidence = decoded.column.confidence;
  if (std::any_of(confidence.begin(), confidence.end(), [](float c) { return c > 0; })) return "";
  size_t bright = 0, dark = 0;
  for (size_t p = 0; p < decoded.white.size(); ++p) {
    if (decoded.white[p] >= kSaturatedLinear) {
      ++bright;
    } else if (!(decoded.contrast[p] >= options.min_contrast)) {
      ++dark;
    }
  }
  const double all = static_cast<double>(std::max<size_t>(1, decoded.white.size()));
  const auto percent = [&](size_t n) {
    return std::to_string(std::lround(100 * static_cast<double>(n) / all)) + " % of its pixels ";
  };
  const std::string problem = "no pixel could be decoded: ";
  constexpr double kWorthSaying = 0.01;
  if (static_cast<double>(bright) >= kWorthSaying * all) {
    return problem + percent(bright) + "are saturated; expose less";
  }
  if (2 * dark >= decoded.white.size()) {
    return problem + percent(dark) +
           "do not show the projector's light; expose more, or aim the projector";
  }
  return problem + "its frames contradict each other; are they in the order of the roles?";
}

/// Decodes one set into `out`; counts what it reads.
void DecodeSet(const ScanSet& set, const DecodingTask& task, Progress& progress, int64_t& read,
               DecodedSet& out) {
  if (set.frames.size() != task.sequence->patterns.size()) {
    throw Error("it has " + std::to_string(set.frames.size()) + " frames, its roles are " +
                std::to_string(task.sequence->patterns.size()));
  }
  const FrameLoader load = [&](int index) {
    progress.Advance();
    ++read;
    return task.load_image(set.frames[static_cast<size_t>(index)]);
  };
  DecodeOptions decode_options;
  decode_options.min_contrast = task.options.min_contrast;
  DecodedPixels decoded = Decode(*task.sequence, load, decode_options);
  if (decoded.width != task.camera.width || decoded.height != task.camera.height) {
    throw Error("its pictures have " + Size(decoded.width, decoded.height) +
                " pixels, the calibrated camera " + Size(task.camera.width, task.camera.height));
  }
  const std::string nothing = WhyNothing(decoded, task.options);
  if (!nothing.empty()) throw Error(nothing);
  out.plate =
      PlateCorrespondences(decoded, task.rays, task.board, task.calib.platform_shape.bend_per_mm,
                           out.platform, task.plate_points);
  out.pixels.width = decoded.width;
  out.pixels.height = decoded.height;
  out.pixels.column = std::move(decoded.column);
}

}  // namespace

std::vector<DecodedSet> DecodeSets(const std::vector<ScanSet>& sets,
                                   const std::vector<PosedImage>& poses, const DecodingTask& task,
                                   Progress& progress) {
  std::vector<DecodedSet> decoded(sets.size());
  ParallelFor(0, static_cast<int64_t>(sets.size()), [&](int64_t i) {
    const ScanSet& set = sets[static_cast<size_t>(i)];
    DecodedSet& out = decoded[static_cast<size_t>(i)];
    out.id = set.id;
    const PosedImage* pose = FindPose(poses, set.id);
    if (pose == nullptr) {
      out.reason = WhyNoPose(task.calib, set);
      progress.Advance(static_cast<int64_t>(set.frames.size()));
      return;
    }
    out.platform = {pose->camera_from_world, pose->covariance, pose->seen};
    int64_t read = 0;
    try {
      DecodeSet(set, task, progress, read, out);
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::kSystem) throw;
      out.reason = error.what();
      progress.Advance(std::max<int64_t>(0, static_cast<int64_t>(set.frames.size()) - read));
    }
  });
  return decoded;
}

PatternSequence RequireColumns(const Capture& capture, const std::vector<std::string>& roles,
                               const char* key) {
  const Scanner& scanner = *capture.scanner;
  const PatternSequence sequence =
      SequenceFromNames(scanner.projector_width, scanner.projector_height, roles);
  RequireComplete(sequence);
  const bool columns =
      std::any_of(sequence.patterns.begin(), sequence.patterns.end(), [](const Pattern& pattern) {
        return pattern.axis == PatternAxis::kColumn && pattern.kind != PatternKind::kWhite &&
               pattern.kind != PatternKind::kBlack;
      });
  if (!columns) {
    throw Error((capture.folder / "capture.json").string() + ": scanner." + key +
                ": names no column patterns (\"column-gray-0\", ...), and points are measured by "
                "projector columns; scan with them");
  }
  return sequence;
}

void RequireSameSize(const Capture& capture, const Camera& calibrated) {
  const std::string& name = capture.scanner->camera;
  const CaptureCamera& camera = capture.cameras.at(name);
  if (calibrated.width == camera.width && calibrated.height == camera.height) return;
  throw Error("the scanner's camera \"" + name + "\" was calibrated for pictures of " +
              Size(calibrated.width, calibrated.height) +
              " pixels, but those of the capture have " + Size(camera.width, camera.height) +
              "; run lfm-calib again on this capture");
}

}  // namespace lfm
