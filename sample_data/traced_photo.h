// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/image.h"
#include "core/pose.h"
#include "sample_data/path_tracer.h"
#include "sample_data/pixel_rays.h"

namespace lfm {

struct TraceOptions {
  int samples_per_pixel = 16;  ///< 1 or more; above 4, rounded up to a multiple of 4
  uint64_t seed = 1;
  uint64_t picture = 0;  ///< pictures of one seed have random numbers of their own
};

/// A photograph before the sensor, and how far it can be trusted.
struct TracedPhoto {
  Image radiance;  ///< linear float RGB, scene units; box-filtered pixels
  Image mask;      ///< 8 bit, one channel: 255 where the pixel centre's ray meets an object first
  /// Standard error of each value of `radiance` (float RGB), from the spread of independent sets of
  /// 4 stratified samples (of single samples where there are fewer than 8). Itself an estimate:
  /// meaningful averaged over many pixels. 0 when there is one sample.
  Image standard_error;
  RayCounts rays;
};

/// Traces a photograph. The same options give the same bytes whatever the number of threads.
/// Doubling the samples lowers the standard error by sqrt(2). Throws Error when samples_per_pixel
/// is below 1 or above 65536.
TracedPhoto TracePhoto(const PathTracer& tracer, const PixelRays& rays,
                       const Pose& camera_from_world, const TraceOptions& options);

}  // namespace lfm
