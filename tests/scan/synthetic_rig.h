// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/capture.h"
#include "core/image.h"
#include "core/pose.h"
#include "scan/patterns.h"
#include "scan/scan.h"

namespace lfm::testing {

/// A rig with known numbers: 240 x 180 camera, 512 x 384 projector, 22 degrees apart.
inline RigCalibration KnownRig(bool distorted) {
  RigCalibration rig;
  rig.camera = {240, 180, 520, 521, 119.2, 90.1};
  rig.projector = {512, 384, 760, 758, 260.3, 188.6};
  if (distorted) {
    rig.camera.k1 = -0.08;
    rig.camera.k2 = 0.02;
    rig.camera.p1 = 4e-4;
    rig.projector.k1 = 0.05;
    rig.projector.p2 = -5e-4;
  }
  const Pose camera_from_world = LookAt({0, -430, 330}, {0, 0, 20}, {0, 0, 1});
  const Pose projector_from_world = LookAt({190, -400, 340}, {0, 0, 20}, {0, 0, 1});
  rig.projector_from_camera = projector_from_world * camera_from_world.Inverse();
  return rig;
}

/// The platform's pose for a scan: the rig looks down on it, turned about its axis.
inline Pose TurnedPlatform(double degrees) {
  const Pose base = LookAt({0, -430, 330}, {0, 0, 20}, {0, 0, 1});
  const double angle = degrees * std::numbers::pi / 180;
  return base * Pose{Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix(),
                     Eigen::Vector3d::Zero()};
}

/// The same, tilted by `degrees` about the horizontal axis at `direction` degrees, and raised.
inline Pose TiltedPlatform(double degrees, double direction, double raised_mm) {
  const double radians = std::numbers::pi / 180;
  const Eigen::Vector3d axis(std::cos(direction * radians), std::sin(direction * radians), 0);
  const Pose tilt{Eigen::AngleAxisd(degrees * radians, axis).toRotationMatrix(), {0, 0, raised_mm}};
  return TurnedPlatform(0) * tilt;
}

inline std::vector<Pose> TiltedPlacements() {
  return {TiltedPlatform(0, 0, 10), TiltedPlatform(28, 0, 25), TiltedPlatform(-22, 20, 30),
          TiltedPlatform(25, 90, 20), TiltedPlatform(-30, 110, 35)};
}

struct SurfaceHit {
  double distance = 0;
  Eigen::Vector3d normal = {0, 0, 1};
  double albedo = 0.8;
};
/// First hit of a ray given in the world (unit direction).
using Surface = std::function<std::optional<SurfaceHit>(const Eigen::Vector3d& origin,
                                                        const Eigen::Vector3d& direction)>;

inline std::optional<SurfaceHit> HitPlate(const Eigen::Vector3d& origin,
                                          const Eigen::Vector3d& direction) {
  const double t = -origin.z() / direction.z();
  if (!(t > 0)) return std::nullopt;
  return SurfaceHit{t, {0, 0, 1}, 0.8};
}

inline std::optional<SurfaceHit> HitSphere(const Eigen::Vector3d& origin,
                                           const Eigen::Vector3d& direction,
                                           const Eigen::Vector3d& center, double radius) {
  const Eigen::Vector3d to_center = center - origin;
  const double along = to_center.dot(direction);
  const double off2 = to_center.squaredNorm() - along * along;
  if (along <= 0 || off2 >= radius * radius) return std::nullopt;
  const double t = along - std::sqrt(radius * radius - off2);
  return SurfaceHit{t, (origin + t * direction - center).normalized(), 0.8};
}

struct RenderSettings {
  double light = 1.1;  ///< linear value of an albedo of 1 lit at right angles
  double ambient = 0.01;
  double noise = 0.002;  ///< standard deviation, linear
  int samples = 3;       ///< a side of a pixel
  uint32_t seed = 1;
};

/// What one camera pixel gathers from: projector coordinates and weight of each sample.
struct LitSample {
  Eigen::Vector2d projector_px = {0, 0};
  double weight = 0, ambient = 0;
};

inline std::vector<std::vector<LitSample>> TraceScan(const RigCalibration& rig,
                                                     const Pose& camera_from_world,
                                                     const Surface& surface,
                                                     const RenderSettings& settings) {
  const Pose world_from_camera = camera_from_world.Inverse();
  const Pose projector_from_world = rig.projector_from_camera * camera_from_world;
  const Eigen::Vector3d eye = camera_from_world.Center();
  const Eigen::Vector3d lamp = projector_from_world.Center();
  std::vector<std::vector<LitSample>> pixels;
  const int n = settings.samples;
  for (int y = 0; y < rig.camera.height; ++y) {
    for (int x = 0; x < rig.camera.width; ++x) {
      std::vector<LitSample> samples;
      for (int s = 0; s < n * n; ++s) {
        const Eigen::Vector2d pixel(x + (s % n + 0.5) / n - 0.5, y + (s / n + 0.5) / n - 0.5);
        const Eigen::Vector3d direction = world_from_camera.rotation * Unproject(rig.camera, pixel);
        const std::optional<SurfaceHit> hit = surface(eye, direction);
        if (!hit) continue;
        LitSample sample;
        sample.ambient = settings.ambient * hit->albedo;
        const Eigen::Vector3d point = eye + hit->distance * direction;
        const Eigen::Vector3d to_point = (point - lamp).normalized();
        const std::optional<SurfaceHit> lit = surface(lamp, to_point);
        const bool reached = lit && lit->distance > (point - lamp).norm() - 1e-6;
        const std::optional<Eigen::Vector2d> source =
            Project(rig.projector, projector_from_world * point);
        if (reached && source && rig.projector.Contains(*source)) {
          sample.projector_px = *source;
          sample.weight = settings.light * hit->albedo * std::max(0.0, -hit->normal.dot(to_point));
        }
        samples.push_back(sample);
      }
      pixels.push_back(samples);
    }
  }
  return pixels;
}

/// What a pattern sends through each column (row): it is constant along the other axis.
inline std::vector<double> PatternProfile(const PatternSequence& sequence, const Pattern& pattern) {
  std::vector<double> profile;
  const bool columns = pattern.axis == PatternAxis::kColumn;
  const int size = columns ? sequence.projector_width : sequence.projector_height;
  for (int i = 0; i < size; ++i) {
    profile.push_back(PatternValue(sequence, pattern, columns ? i : 0, columns ? 0 : i));
  }
  return profile;
}

inline Image RenderFrame(const std::vector<std::vector<LitSample>>& traced, const Camera& camera,
                         const PatternSequence& sequence, int frame,
                         const RenderSettings& settings) {
  const Pattern& pattern = sequence.patterns[static_cast<size_t>(frame)];
  const std::vector<double> profile = PatternProfile(sequence, pattern);
  const int axis = pattern.axis == PatternAxis::kColumn ? 0 : 1;
  std::mt19937 random(settings.seed * 1000 + static_cast<uint32_t>(frame));
  std::normal_distribution<double> noise(0, 1);
  Image linear(camera.width, camera.height, 1, PixelType::kFloat32, ColorEncoding::kLinear);
  const double samples = settings.samples * settings.samples;
  for (size_t p = 0; p < traced.size(); ++p) {
    double sum = 0;
    for (const LitSample& s : traced[p]) {
      sum += s.ambient;
      if (s.weight <= 0) continue;
      sum += s.weight * profile[static_cast<size_t>(std::lround(s.projector_px[axis]))];
    }
    linear.Data<float>()[p] = static_cast<float>(sum / samples + settings.noise * noise(random));
  }
  return ToSrgb8(linear);
}

/// All frames of one scan.
inline std::vector<Image> RenderScan(const RigCalibration& rig, const Pose& camera_from_world,
                                     const Surface& surface, const PatternSequence& sequence,
                                     const RenderSettings& settings) {
  const auto traced = TraceScan(rig, camera_from_world, surface, settings);
  std::vector<Image> frames;
  for (int i = 0; i < static_cast<int>(sequence.patterns.size()); ++i) {
    frames.push_back(RenderFrame(traced, rig.camera, sequence, i, settings));
  }
  return frames;
}

}  // namespace lfm::testing
