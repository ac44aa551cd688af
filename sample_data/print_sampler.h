// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "core/pose.h"
#include "sample_data/pixel_rays.h"
#include "sample_data/studio_scene.h"

namespace lfm {

/// The print as the pixels of one picture integrate it, without a ray more: by areas, exact where
/// two of its lines cross a cell or fewer (elsewhere, on circles and rims, by nine places a cell).
/// Places would misjudge parallel edges alike, which moves all corners together. Usable from many
/// threads.
class PrintSampler {
 public:
  PrintSampler(const SetReflectance& reflectance, const PixelRays& rays,
               const Pose& camera_from_world);

  /// Mean linear RGB albedo that pixel (x, y) sees of the plane of `patch`, over the one of its
  /// kFineSamples square cells that holds this point of kFinePattern.
  Eigen::Vector3f CellColor(const Patch& patch, int x, int y, int cell) const;
  /// The mean of all cells.
  Eigen::Vector3f PixelColor(const Patch& patch, int x, int y) const;
  /// Whether the albedo of that plane differs between the pixel's corners.
  bool CornersDiffer(const Patch& patch, int x, int y) const;

 private:
  /// Where that place of the pixel sees the plane of `patch`; world.
  Eigen::Vector3f PointAt(const Patch& patch, int x, int y, float dx, float dy) const;

  const SetReflectance& reflectance_;
  const PixelRays& rays_;
  Eigen::Matrix3f world_from_camera_;
  Eigen::Vector3f eye_;
};

}  // namespace lfm
