// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <random>
#include <string>

#include "core/error.h"
#include "scan/scan.h"
#include "tests/scan/synthetic_rig.h"

namespace lfm::testing {

inline constexpr double kBallRadius = 42;
inline const Eigen::Vector3d kBallCenter(5, -3, 38);

inline std::optional<SurfaceHit> BallOnPlate(const Eigen::Vector3d& origin,
                                             const Eigen::Vector3d& direction) {
  const auto ball = HitSphere(origin, direction, kBallCenter, kBallRadius);
  const auto plate = HitPlate(origin, direction);
  if (ball && (!plate || ball->distance < plate->distance)) return ball;
  return plate;
}

/// A ball on a plate, scanned from four sides, and the empty plate in five placements.
struct Studio {
  RigCalibration rig = KnownRig(true);
  Capture capture;
  CalibResult calib;
  Board board;
  std::map<std::string, Image> files;
  int samples_a_side;

  /// A pixel gathers light at `samples` x `samples` places.
  explicit Studio(int samples = 3) : samples_a_side(samples) {
    board.width_mm = board.height_mm = 220;
    capture.name = "ball";
    capture.cameras["scanner"] = {rig.camera.width, rig.camera.height, std::nullopt};
    calib.cameras["scanner"] = rig.camera;
    Scanner scanner;
    scanner.camera = "scanner";
    scanner.projector_width = rig.projector.width;
    scanner.projector_height = rig.projector.height;
    const auto columns =
        MakePatternSequence(rig.projector.width, rig.projector.height, PatternRows::kWithout);
    const auto both =
        MakePatternSequence(rig.projector.width, rig.projector.height, PatternRows::kWith);
    for (const Pattern& p : columns.patterns) scanner.scan_roles.push_back(PatternName(p));
    for (const Pattern& p : both.patterns) scanner.placement_roles.push_back(PatternName(p));
    for (int i = 0; i < 4; ++i) {
      scanner.scans.push_back(Add("scan-" + std::to_string(i), TurnedPlatform(90 * i), BallOnPlate,
                                  columns, calib.scans));
    }
    int placement = 0;
    for (const Pose& pose : TiltedPlacements()) {
      scanner.placements.push_back(
          Add("placement-" + std::to_string(placement++), pose, HitPlate, both, calib.placements));
    }
    capture.scanner = scanner;
  }

  ScanSet Add(const std::string& id, const Pose& pose, const Surface& surface,
              const PatternSequence& sequence, std::vector<PosedImage>& poses) {
    RenderSettings settings;
    settings.seed = static_cast<uint32_t>(files.size()) + 1;
    settings.samples = samples_a_side;
    ScanSet set;
    set.id = id;
    const std::vector<Image> frames = RenderScan(rig, pose, surface, sequence, settings);
    for (size_t i = 0; i < frames.size(); ++i) {
      set.frames.push_back(id + "/" + std::to_string(i) + ".png");
      files[set.frames.back()] = frames[i];
    }
    PosedImage posed;
    posed.id = id;
    posed.camera = "scanner";
    posed.camera_from_world = pose;
    posed.corners = 40;
    posed.reprojection_rms_px = 0.1;
    poses.push_back(posed);
    return set;
  }

  /// Replaces a scan's frames by those of another surface.
  void Rescan(size_t index, const Surface& surface, const RenderSettings& settings = {}) {
    const auto columns =
        MakePatternSequence(rig.projector.width, rig.projector.height, PatternRows::kWithout);
    const std::vector<Image> frames =
        RenderScan(rig, calib.scans[index].camera_from_world, surface, columns, settings);
    const ScanSet& set = capture.scanner->scans[index];
    for (size_t i = 0; i < frames.size(); ++i) files[set.frames[i]] = frames[i];
  }

  /// Gives every picture of the rig the corners of a 9 x 9 grid on the plate, seen with noise.
  void ShowCorners(double noise_px, uint32_t seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, 1);
    calib.lens_terms["scanner"] = 4;
    for (auto* poses : {&calib.scans, &calib.placements}) {
      for (PosedImage& posed : *poses) {
        for (int i = 0; i < 81; ++i) {
          const Eigen::Vector3d point(22.0 * (i % 9 - 4), 22.0 * (i / 9 - 4), 0);
          const auto pixel = Project(rig.camera, posed.camera_from_world * point);
          if (!pixel || !rig.camera.Contains(*pixel)) continue;
          const Eigen::Vector2d off(normal(random), normal(random));
          posed.seen.push_back({point, *pixel + noise_px * off});
        }
      }
    }
  }

  ImageLoader Loader() const {
    return [this](const std::string& file) {
      const auto found = files.find(file);
      if (found == files.end()) throw Error(file + ": no such file");
      return found->second;
    };
  }
};

inline const Studio& TheStudio() {
  static const Studio studio;
  return studio;
}

inline ScanResult RunScan(const Studio& studio, const ScanOptions& options = {},
                          const std::optional<lfm::KnownRig>& known = std::nullopt) {
  return Scan(studio.capture, studio.board, studio.calib, studio.Loader(), options,
              SilentProgress(), known);
}

inline std::string ErrorOf(const Studio& studio,
                           const std::optional<lfm::KnownRig>& known = std::nullopt) {
  try {
    RunScan(studio, {}, known);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

inline double MedianDistanceToBall(const PointCloud& cloud) {
  std::vector<double> distances;
  for (const Eigen::Vector3d& p : cloud.points) {
    distances.push_back(std::abs((p - kBallCenter).norm() - kBallRadius));
  }
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

}  // namespace lfm::testing
