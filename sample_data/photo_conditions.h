// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/camera.h"
#include "core/photo_split.h"
#include "core/pose.h"
#include "sample_data/pixel_rays.h"
#include "sample_data/trouble.h"

namespace lfm {

/// What is particular to one photograph.
struct PhotoConditions {
  double exposure_stops = 0;                   ///< above the nominal exposure
  Eigen::Vector3f gains = {1, 1, 1};           ///< white balance; green is 1
  Eigen::Vector3d travel_mm = {0, 0, 0};       ///< of the eye during the exposure, camera frame
  bool occluded = false, half_framed = false;  ///< see PhotoTrouble; never of test photographs
};

/// Draws the conditions of all photographs; the n-th has split `splits[n]`. Exactly the stated
/// share of the training photographs, rounded, is occluded or half framed. Exposures are normal
/// with the stated sigma; the gains of red and blue are exp(percent / 100 N), N normal, so that a
/// small percentage is their deviation; travel is sideways, evenly in all directions. Test
/// photographs are exposed, balanced and shaken as the others are.
std::vector<PhotoConditions> DrawPhotoConditions(const PhotoTrouble& trouble,
                                                 const std::vector<PhotoSplit>& splits,
                                                 uint64_t seed);

/// Share of light that reaches a pixel: with r its distance from the picture's middle, in units of
/// half the picture's diagonal,
///   (1 + (2^(stops / 2) - 1) r^2)^-2,
/// which is cos^4 of the field angle of a lens that loses `stops` in the corners.
double VignettingGain(const Camera& camera, double stops, double x, double y);

/// The camera turned about its eye so that `point` (world) lies on a border of the picture:
/// half of what surrounds the point is outside. `side` 0 to 3: left, top, right, bottom; `along` in
/// [0, 1] says where on the border.
Pose AimAtBorder(const Camera& camera, const Pose& camera_from_world, const Eigen::Vector3d& point,
                 int side, double along);

/// One of the pinhole pictures that an exposure through a lens, or with a moving eye, averages.
struct ExposureSample {
  Pose camera_from_world;
  float shift_x = 0, shift_y = 0;  ///< for PixelRays::Shifted
};

/// The pinhole pictures of one exposure; one, unchanged, when the eye neither moves nor has a size.
///
/// Thin lens: the rays of a pixel leave all points of the lens and meet in the plane of focus, at
/// depth F; through the point (a, b, 0) of the lens goes (x - a / F, y - b / F, 1). A point at
/// depth z is spread over a circle of diameter |aperture fx (1/F - 1/z)| pixels. Distortion is that
/// of the ray through the middle. Motion: the eye goes evenly along `travel_mm`, the pose being
/// that of the middle of the exposure; it does not turn. Points of the lens and times are spread
/// evenly; their means are those of the pinhole. Blur wider than about a fifth of the number of
/// samples, in pixels, shows single pictures.
std::vector<ExposureSample> ExposureSamples(const Pose& camera_from_world,
                                            const Eigen::Vector3d& travel_mm, double aperture_mm,
                                            double focus_depth_mm, int samples);

}  // namespace lfm
