// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/scan_session.h"

#include <cstdio>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "sample_data/camera_path.h"
#include "sample_data/pattern_table.h"
#include "sample_data/plate.h"
#include "sample_data/random.h"
#include "sample_data/scan_renderer.h"
#include "sample_data/scan_rig.h"
#include "scan/patterns.h"

namespace lfm {
namespace {

constexpr uint64_t kScanPictures = 1u << 20, kPlacementPictures = 1u << 21;
constexpr uint64_t kFrameWobbleStream = 53;
constexpr int kNoiseRowStep = 40;

std::string Numbered(const char* format, int number) {
  char text[64];
  std::snprintf(text, sizeof(text), format, number);
  return text;
}

PatternOptions MakePatternOptions(const StudioOptions& options) {
  PatternOptions patterns;
  patterns.scheme = options.patterns;
  patterns.phase_steps = options.phase_steps;
  patterns.stripe = {StripeProfile::kGauss, options.stripe_width_px, options.stripe_step_px};
  return patterns;
}

std::vector<std::string> RoleNames(const PatternSequence& sequence) {
  std::vector<std::string> names;
  for (const Pattern& pattern : sequence.patterns) names.push_back(PatternName(pattern));
  return names;
}

class ScanSession {
 public:
  ScanSession(const StudioOptions& options, const ScannedSet& set, const Sensor& sensor,
              std::string ending, const PictureSink& sink, Progress& progress)
      : options_(options),
        set_(set),
        sensor_(sensor),
        ending_(std::move(ending)),
        sink_(sink),
        progress_(progress),
        seed_(static_cast<uint64_t>(options.seed)),
        rig_(MakeScanRig(options.scan_width, options.scan_height, options.projector_width,
                         options.projector_height)),
        rays_(rig_.camera),
        exposure_(MakeScanExposure(options.trouble.scan)) {
    if (options.quality == RenderQuality::kReference) {
      exposure_.bounce_rays = options.SamplesPerPixel(exposure_.bounce_rays);
    }
  }

  TakenScans Run(const std::string& camera_name) {
    const StageClock clock;
    const PatternOptions patterns = MakePatternOptions(options_);
    const PatternSequence columns = MakePatternSequence(rig_.projector.width, rig_.projector.height,
                                                        PatternRows::kWithout, patterns);
    const PatternSequence both = MakePatternSequence(rig_.projector.width, rig_.projector.height,
                                                     PatternRows::kWith, patterns);
    Scanner& scanner = taken_.scanner;
    scanner.camera = camera_name;
    scanner.projector_width = rig_.projector.width;
    scanner.projector_height = rig_.projector.height;
    scanner.scan_roles = RoleNames(columns);
    scanner.placement_roles = RoleNames(both);
    progress_.Start("scans", options_.scans + options_.placements);
    const std::vector<Pose> poses = TakeObject(columns);
    const std::vector<PlatformPlacement> placements = TakePlacements(both);
    taken_.camera = rig_.camera;
    taken_.truth = scanner;
    taken_.truth.projector = rig_.projector;
    taken_.truth.projector_from_camera = rig_.projector_from_camera;
    for (size_t i = 0; i < poses.size(); ++i) {
      taken_.truth.scans[i].camera_from_world = poses[i];
    }
    for (size_t i = 0; i < placements.size(); ++i) {
      taken_.truth.placements[i].camera_from_world = placements[i].camera_from_world;
    }
    taken_.report.name = "scans";
    clock.Stop(taken_.report);
    return std::move(taken_);
  }

 private:
  std::vector<Pose> TakeObject(const PatternSequence& sequence) {
    const PatternTable patterns(sequence, options_.trouble.scan);
    std::vector<Pose> poses = TroubleScanPoses(
        MakeScanPoses(options_.scans, options_.rig_low_deg, options_.rig_high_deg),
        options_.trouble.platform.axis_tilt_deg, options_.trouble.platform.wobble_mm, seed_);
    const ScanSubject painted{&set_.scene, &set_.mesh, &set_.reflectance};
    for (int i = 0; i < options_.scans; ++i) {
      const ScanFrames frames = TakeOne(painted, poses[i], patterns, i);
      taken_.scanner.scans.push_back(
          WriteFrames("scans/", Numbered("scan_%02d", i), taken_.scanner.scan_roles, frames));
      progress_.Advance();
    }
    if (options_.scans > 0) {
      const ScanNoise measured =
          MeasureScanNoise(painted, rig_, rays_, poses[0], patterns, exposure_, sensor_, seed_,
                           kScanPictures, kNoiseRowStep);
      taken_.report.noise = measured.noise;
      taken_.report.rays += measured.rays;
    }
    return poses;
  }

  // Of a platform that wobbles from frame to frame, each frame comes from a scan of its own.
  ScanFrames TakeOne(const ScanSubject& painted, const Pose& pose, const PatternTable& patterns,
                     int index) const {
    const uint64_t picture = kScanPictures + static_cast<uint64_t>(index);
    const auto render = [&](const Pose& camera_from_world) {
      return RenderScan(painted, rig_, rays_, camera_from_world, patterns, exposure_, sensor_,
                        seed_, picture);
    };
    const double wobble_mm = options_.trouble.platform.frame_wobble_mm;
    if (wobble_mm == 0) return render(pose);
    ScanFrames frames;
    for (int f = 0; f < patterns.frames(); ++f) {
      RandomStream random(seed_, kFrameWobbleStream, picture << 16 | static_cast<uint64_t>(f));
      ScanFrames whole = render(pose * Wobble(wobble_mm, random));
      frames.pictures.push_back(std::move(whole.pictures[f]));
      frames.rays += whole.rays;
    }
    return frames;
  }

  std::vector<PlatformPlacement> TakePlacements(const PatternSequence& sequence) {
    const PatternTable patterns(sequence, options_.trouble.scan);
    std::vector<PlatformPlacement> placements = MakePlacements(options_.placements);
    for (int i = 0; i < options_.placements; ++i) {
      const StudioScene empty(
          nullptr, MakeBentPlateAndTable(set_.board, options_.trouble.platform.plate_sag_mm,
                                         placements[i].world_from_table));
      const ScanFrames frames = RenderScan(
          {&empty, nullptr, &set_.reflectance}, rig_, rays_, placements[i].camera_from_world,
          patterns, exposure_, sensor_, seed_, kPlacementPictures + static_cast<uint64_t>(i));
      taken_.scanner.placements.push_back(WriteFrames("placements/", Numbered("placement_%02d", i),
                                                      taken_.scanner.placement_roles, frames));
      progress_.Advance();
    }
    return placements;
  }

  ScanSet WriteFrames(const std::string& folder, const std::string& id,
                      const std::vector<std::string>& roles, const ScanFrames& frames) {
    taken_.report.rays += frames.rays;
    ScanSet set;
    set.id = id;
    for (const std::string& role : roles) {
      set.frames.push_back(folder + id + "/" + role + ending_);
    }
    ParallelFor(0, static_cast<int64_t>(frames.pictures.size()),
                [&](int64_t f) { sink_(set.frames[f], frames.pictures[f]); });
    return set;
  }

  const StudioOptions& options_;
  const ScannedSet& set_;
  const Sensor& sensor_;
  std::string ending_;
  const PictureSink& sink_;
  Progress& progress_;
  uint64_t seed_;
  ScanRig rig_;
  PixelRays rays_;
  ScanExposure exposure_;
  TakenScans taken_;
};

}  // namespace

TakenScans TakeScans(const StudioOptions& options, const ScannedSet& set, const Sensor& sensor,
                     const std::string& camera_name, const std::string& ending,
                     const PictureSink& sink, Progress& progress) {
  return ScanSession(options, set, sensor, ending, sink, progress).Run(camera_name);
}

}  // namespace lfm
