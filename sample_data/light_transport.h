// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/cube_map.h"
#include "sample_data/path_tracer.h"
#include "sample_data/traced_scene.h"

namespace lfm {

struct TransportOptions {
  CubeMap cube;
  /// Shadow rays towards each texel above the surface: the middles of g x g parts of it, g the
  /// rounded root. 1 is the texel's middle.
  int samples_per_texel = 1;
  /// Paths drawn from the BSDF; they carry the bounces, and lobes much narrower than a texel.
  int paths = 64;
  int bounces = 0;  ///< of light between surfaces, counted as the path tracer does
  uint64_t seed = 1;
};

/// One row of the light transport matrix: what a surface point sends to the eye for light from
/// everywhere,
///
///   radiance = sum over texels of row[texel] * radiance of the texel   (a colour channel each)
///
/// with radiance constant over a texel. Texels in CubeMap's order, 3 values (RGB) each.
///
/// Direct light is the BSDF times the cosine, integrated over the texel by the midpoint rule (1 to
/// 64 points, by the lobe's width; within 1 % of the texel's share where the lobe is wider than a
/// sixth of a texel), times the share of the texel's shadow rays that pass: no random numbers, so
/// no noise in the matrix's small singular values. A narrower lobe takes random points of texels
/// and the BSDF's samples together, weighed by the balance heuristic (Veach and Guibas 1995), and
/// is unbiased for any exponent. Delta lobes are samples of the BSDF alone. Bounced light is
/// carried by paths; each that leaves the scene adds to one texel. The scene's lamps play no part.
class TransportRow {
 public:
  /// The scene must outlive this. Throws Error unless the cube's resolution is 1 to 1024, samples
  /// at least 1, paths and bounces not negative.
  TransportRow(const TracedScene& scene, const TransportOptions& options);

  /// `surface` as seen from `to_eye` (unit); `stream` keeps rows' random numbers apart. Adds
  /// `weight` times the row to `row` (cube.Texels() x 3).
  RayCounts Add(const SurfacePoint& surface, const Eigen::Vector3f& to_eye, uint64_t stream,
                float weight, float* row) const;
  /// The same for whatever a ray (unit direction) meets first: a pixel of a transport image. A ray
  /// that meets nothing sees one texel, with weight 1. Returns the index of the object that it met,
  /// -1 for the set, -2 for nothing.
  int AddRay(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, uint64_t stream,
             float weight, float* row, RayCounts* rays = nullptr) const;

 private:
  struct Gathering;  // one row's work
  void AddMiddles(Gathering& g) const;
  void AddRandomPoints(Gathering& g) const;
  void AddPaths(Gathering& g) const;

  const TracedScene& scene_;
  TransportOptions options_;
  std::vector<Eigen::Vector3f> middles_;  // of the texels, unit
};

}  // namespace lfm
