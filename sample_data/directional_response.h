// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

#include "sample_data/path_tracer.h"
#include "sample_data/traced_scene.h"

namespace lfm {

/// What a camera ray shows under each of many parallel lights, alone: a row of a reflectance field
/// (Yamada 2009, Section 2). All lights share the paths; only shadow rays are cast for each.
///
/// Every light gives irradiance `irradiance` on a surface that faces it. At every surface of a path
/// that is not a delta lobe each light is asked; light that mirrors and clear glass would show as
/// points is not seen, for it comes from one direction alone. `bounces` and what is not counted as
/// one are as in PathTracer. `indirect_limit` is the most radiance that one path may bring for one
/// light from behind a counted bounce: a finite one cuts off what few paths find by luck, caustics
/// above all, and darkens the picture by what it cuts.
class DirectionalResponse {
 public:
  /// The scene must outlive this. Throws Error for an empty list, a direction that is not a unit
  /// vector, bounces outside [0, 64] and a limit that is not positive.
  DirectionalResponse(const TracedScene& scene, std::vector<Eigen::Vector3f> to_lights,
                      float irradiance, int bounces,
                      float indirect_limit = std::numeric_limits<float>::infinity());

  size_t lights() const { return to_lights_.size(); }
  /// Adds `weight` times the radiance of each ray (unit direction) to `row`
  /// (lights x 3). Their keys keep the random numbers of paths apart.
  RayCounts Add(const std::vector<PathRay>& rays, float weight, float* row) const;

 private:
  struct Path;
  void AskLights(const SurfacePoint& point, const Path& path, float weight, float* row,
                 RayCounts& counts) const;
  bool Scatter(const SurfacePoint& point, Path& path) const;

  const TracedScene& scene_;
  std::vector<Eigen::Vector3f> to_lights_;
  float irradiance_;
  int bounces_;
  float indirect_limit_;
};

}  // namespace lfm
