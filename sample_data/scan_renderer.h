// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"
#include "core/pose.h"
#include "core/triangle_mesh.h"
#include "sample_data/pixel_rays.h"
#include "sample_data/scan_rig.h"
#include "sample_data/sensor.h"
#include "sample_data/studio_scene.h"
#include "scan/patterns.h"

namespace lfm {

/// How bright the scanner's pictures are.
struct ScanExposure {
  double white = 0.82;     ///< linear value of painted surface facing the projector, at kNearMm
  double ambient = 0.015;  ///< linear value that an unshadowed painted surface has in the dark
};
/// Depth before the projector that `ScanExposure::white` is meant for.
inline constexpr double kNearMm = 395;
/// Albedo of the matt white paint.
inline constexpr double kPaintAlbedo = 0.80;

/// A stretch of the projector's columns (or rows): `index`, and `share` of it on the one after.
struct ProjectedSpan {
  int index = 0;
  float share = 0;
};

/// The stretch [center - width / 2, center + width / 2] over pixels of unit width, at most one
/// pixel wide and inside [0, count).
ProjectedSpan MakeSpan(double center, double width, int count);

/// One sample of a pixel under the projector: light proportional to `weight` times what the
/// projector shows at its columns and rows.
struct ProjectedSample {
  ProjectedSpan column, row;
  float weight = 0;
};

/// What a pattern sequence shows at each projector column and row, for all frames at once.
class PatternTable {
 public:
  explicit PatternTable(const PatternSequence& sequence);
  int frames() const { return frames_; }
  /// sums[f] += weight * mean of PatternValue of frame f over the sample's span, for all frames.
  void Accumulate(const ProjectedSample& sample, float* sums) const;
  /// Frames as Accumulate orders them, to manifest order: the frame of slot i.
  const std::vector<int>& frame_of_slot() const { return frame_of_slot_; }

 private:
  static void AddSpan(const std::vector<float>& table, int slots, const ProjectedSpan& span,
                      float weight, float* sums);

  int frames_ = 0, column_slots_ = 0, row_slots_ = 0;
  std::vector<int> frame_of_slot_;
  std::vector<float> by_column_, by_row_;
};

/// The set under the scanner: the object painted white, or none.
struct ScanSubject {
  const StudioScene* scene = nullptr;
  const TriangleMesh* mesh = nullptr;  ///< null when the platform is empty
  const SetReflectance* reflectance = nullptr;
};

/// Renders all frames of one scan or placement as 8-bit sRGB gray pictures with sensor noise. Rays
/// are traced once: 16 samples a pixel, each with its shadow ray to the projector and one bounce of
/// interreflected projector light. The result depends on (seed, picture) only.
std::vector<Image> RenderScan(const ScanSubject& subject, const ScanRig& rig, const PixelRays& rays,
                              const Pose& camera_from_world, const PatternTable& patterns,
                              const ScanExposure& exposure, const Sensor& sensor, uint64_t seed,
                              uint64_t picture);

}  // namespace lfm
