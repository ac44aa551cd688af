// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"
#include "core/pose.h"
#include "core/triangle_mesh.h"
#include "sample_data/pattern_table.h"
#include "sample_data/pixel_rays.h"
#include "sample_data/scan_rig.h"
#include "sample_data/sensor.h"
#include "sample_data/studio_report.h"
#include "sample_data/studio_scene.h"
#include "sample_data/trouble.h"

namespace lfm {

/// How bright the scanner's pictures are, and how the paint spreads light.
struct ScanExposure {
  double white = 0.82;     ///< linear value of painted surface facing the projector, at kNearMm
  double ambient = 0.015;  ///< linear value that an unshadowed painted surface has in the dark
  /// Light that enters the paint at one point leaves at another, a Gaussian of this sigma away in
  /// the tangent plane. Each point of the painted object shows the pattern so averaged; spreading
  /// over edges and shadow borders is left out, and so is the pattern's change of scale within the
  /// blur. The printed plate does not spread light.
  double subsurface_mm = 0;
  /// Of interreflected light, a sample (16 a pixel); 8 times as many where a pixel shows an edge.
  int bounce_rays = 1;
};
/// Exposure of the scanner under `trouble`: ambient light, and both times the exposure factor.
ScanExposure MakeScanExposure(const ScanTrouble& trouble);
/// Depth before the projector that `ScanExposure::white` is meant for.
inline constexpr double kNearMm = 395;
/// Albedo of the matt white paint.
inline constexpr double kPaintAlbedo = 0.80;

/// Frames of one scan, and what they took.
struct ScanFrames {
  std::vector<Image> pictures;
  RayCounts rays;
};

/// The set under the scanner: the object painted white, or none.
struct ScanSubject {
  const StudioScene* scene = nullptr;
  const TriangleMesh* mesh = nullptr;  ///< null when the platform is empty
  const SetReflectance* reflectance = nullptr;
};

/// Renders all frames of one scan or placement as 8-bit sRGB gray pictures with sensor noise. Rays
/// are traced once: 16 samples a pixel, each with its shadow ray to the projector and one bounce of
/// interreflected projector light, filtered (scan_bounce.h). The result depends on (seed, picture)
/// only.
ScanFrames RenderScan(const ScanSubject& subject, const ScanRig& rig, const PixelRays& rays,
                      const Pose& camera_from_world, const PatternTable& patterns,
                      const ScanExposure& exposure, const Sensor& sensor, uint64_t seed,
                      uint64_t picture);

struct ScanNoise {
  NoiseTally noise;
  RayCounts rays;  ///< that measuring took
};
/// The Monte Carlo error of that scan beside the sensor's noise: every `row_step`-th row (with the
/// rows that its filter reads) is traced twice, with independent random numbers.
ScanNoise MeasureScanNoise(const ScanSubject& subject, const ScanRig& rig, const PixelRays& rays,
                           const Pose& camera_from_world, const PatternTable& patterns,
                           const ScanExposure& exposure, const Sensor& sensor, uint64_t seed,
                           uint64_t picture, int row_step);

}  // namespace lfm
