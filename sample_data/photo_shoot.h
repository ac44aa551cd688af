// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

#include "core/image.h"
#include "core/photo_split.h"
#include "core/pose.h"
#include "sample_data/lighting.h"
#include "sample_data/photo_conditions.h"
#include "sample_data/photo_renderer.h"
#include "sample_data/pixel_rays.h"
#include "sample_data/sensor.h"
#include "sample_data/trouble.h"

namespace lfm {

/// Renders a pinhole picture of the scene along these rays.
using PhotoRenderer =
    std::function<RenderedPhoto(const PixelRays& rays, const Pose& camera_from_world)>;

/// What all photographs of a capture have in common.
struct PhotoShoot {
  const PixelRays& rays;
  const Lighting& lighting;  ///< of what stands in the way
  const PhotoTrouble& trouble;
  PhotoRenderer render;
  Sensor sensor;
  float exposure = 1;      ///< a linear value (1: the sensor is full) per unit of radiance
  Eigen::Vector3d center;  ///< of the subject, world: focused at, in the way of
  uint64_t seed = 1;
};

/// One photograph as its file will hold it, and the truth about it.
struct TakenPhoto {
  Image picture;  ///< RGB: 8-bit sRGB, 16-bit linear or float linear, by trouble.format
  Image clean;    ///< test photographs: 8-bit sRGB at the nominal exposure, free of noise, blur,
                  ///< vignetting and jitter; else empty
  Image mask;     ///< of the middle of the exposure, through the lens's middle; without what is
                  ///< covered
};

/// Takes photograph number `index`: averages the pinhole pictures of ExposureSamples, with an
/// occluder drawn over each where there is one; then exposure, white balance, vignetting and the
/// sensor. Depends on the seed, the index and the arguments only.
TakenPhoto TakePhoto(const PhotoShoot& shoot, int index, const Pose& camera_from_world,
                     PhotoSplit split, const PhotoConditions& conditions);

}  // namespace lfm
