// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

#include "core/image.h"
#include "core/photo_split.h"
#include "core/pose.h"
#include "sample_data/occluder.h"
#include "sample_data/photo_conditions.h"
#include "sample_data/photo_renderer.h"
#include "sample_data/pixel_rays.h"
#include "sample_data/sensor.h"
#include "sample_data/studio_report.h"
#include "sample_data/trouble.h"

namespace lfm {

/// What all photographs of a capture have in common.
struct PhotoShoot {
  const PixelRays& rays;
  const PhotoTrouble& trouble;
  PhotoRenderer render, render_test;  ///< training and held-out photographs
  /// Renders the scene with this in the way, its shadow included.
  std::function<PhotoRenderer(const Occluder&)> render_occluded;
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
  RayCounts rays;
  /// Of the pinhole picture in the middle of the exposure, at the nominal exposure; empty when the
  /// renderer does not know its error.
  NoiseTally noise;
};

/// Takes photograph number `index`: averages the pinhole pictures of ExposureSamples, each with the
/// occluder in the way where there is one; then exposure, white balance, vignetting and the
/// sensor. Depends on the seed, the index and the arguments only.
TakenPhoto TakePhoto(const PhotoShoot& shoot, int index, const Pose& camera_from_world,
                     PhotoSplit split, const PhotoConditions& conditions);

}  // namespace lfm
