// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/camera.h"
#include "core/point_cloud.h"
#include "scan/decode.h"
#include "scan/scan.h"
#include "scan/uncertainty.h"

namespace lfm {

/// Normalised, undistorted coordinates (X/Z, Y/Z) through the centre of each pixel, rows from the
/// top; not a number where the lens model folds back: no point is measured there.
std::vector<Eigen::Vector2d> NormalizedRays(const Camera& camera);

/// Depth Z (mm, camera frame) at which the ray (x, y, 1) meets the light that left the projector
/// through `column`: linear in Z for a pinhole; with lens terms the projector's undistorted column
/// depends on the row that Z itself decides, and is iterated until it moves less than 1e-12.
///
/// No answer when ray and light are parallel, meet behind the camera or the projector or outside
/// the projector's picture, or when the iteration does not settle.
std::optional<double> DepthFromColumn(const RigCalibration& rig, const Eigen::Vector2d& ray,
                                      double column);

/// What one scan measured at each camera pixel, camera frame, rows from the top.
struct RangeMap {
  int width = 0, height = 0;
  std::vector<double> depth;            ///< Z, mm; 0 = nothing (left)
  std::vector<Eigen::Vector3f> normal;  ///< unit, towards the scanner
  std::vector<float> confidence;        ///< [0, 1]
  /// Standard deviation across the surface, mm, from decoding (or the neighbourhood's roughness or
  /// the pixel's own distance from what its neighbours say, where those are more) and from what is
  /// not known of the projector; 0 where nothing is measured. What is not known of the scan's pose
  /// is not in it.
  std::vector<float> sigma_mm;
};

/// Triangulates a decoded scan and keeps what its neighbourhood confirms.
///
/// Inverse depth is affine over the picture of a plane. About each pixel a robust affine fit to the
/// inverse depths of the connected pixels within two steps gives the normal and what the
/// neighbours say about the pixel's own depth. Dropped are pixels
/// - that differ from it by more than `max_ray_gap_mm` across the surface (depth edges, mixed
///   pixels, wrong periods),
/// - with fewer than six of eight connected neighbours (single pixels, threads, silhouettes),
/// - seen or lit at more than `max_grazing_deg` from the normal,
/// - below `min_confidence`: the product of decoding, expected error along the ray, roughness, and
///   obliqueness.
/// `rays` are NormalizedRays(rig.camera). Of `decoded` only size and columns are read. Throws Error
/// when sizes disagree.
RangeMap Triangulate(const RigCalibration& rig, const std::vector<Eigen::Vector2d>& rays,
                     const DecodedPixels& decoded, const ScanOptions& options,
                     const RigUncertainty& uncertainty = {});

}  // namespace lfm
