// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "core/image.h"
#include "core/pose.h"
#include "sample_data/coat_shading.h"
#include "sample_data/path_tracer.h"
#include "sample_data/pixel_rays.h"
#include "sample_data/studio_scene.h"

namespace lfm {

/// A photograph before the sensor.
struct RenderedPhoto {
  Image radiance;  ///< linear float RGB, scene units
  Image mask;      ///< 8 bit, one channel: 255 where the pixel centre's ray meets the object first
  Image standard_error;  ///< of each value of `radiance`; empty where it is not known
  RayCounts rays;
};

/// Renders a pinhole picture of some scene along these rays.
using PhotoRenderer =
    std::function<RenderedPhoto(const PixelRays& rays, const Pose& camera_from_world)>;

/// Renders one photograph: box-filtered pixels of 4 samples; 16 where a pixel holds, or a
/// neighbour shows, another surface, or the pixel holds a depth edge; print edges are integrated
/// over the pixel's square without more rays (PrintSampler); the coat is shaded at two opposite
/// samples of a pixel of one surface. No random numbers: the same picture for every number of
/// threads.
RenderedPhoto RenderPhoto(const StudioScene& scene, const CoatShading& shading,
                          const SetReflectance& reflectance, const PixelRays& rays,
                          const Pose& camera_from_world);

}  // namespace lfm
