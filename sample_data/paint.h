// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace lfm {

/// The paint at a surface point: a diffuse base under a metallic GGX coat (sample_data/ggx.h).
struct Paint {
  Eigen::Vector3f diffuse = Eigen::Vector3f::Zero();  ///< albedo of the base, linear RGB
  Eigen::Vector3f coat = Eigen::Vector3f::Zero();  ///< the coat's reflectance at normal incidence
  float alpha = 0.3f;                              ///< GGX roughness, 0.2 to 0.35
};

/// Smooth noise in [-1, 1] with features of about one unit: gradient noise (Perlin 2002) over a
/// lattice hashed with `seed`.
double GradientNoise(const Eigen::Vector3d& p, uint64_t seed);

/// The bust's colours: bronze skin with painted eyes, brows and lips, dark hair, a patterned cloth,
/// a veined stone socle. No feature is narrower than about 1 mm.
Paint PaintBust(const Eigen::Vector3d& point_mm, uint64_t seed);

/// Any other mesh: soft marbling over `base` (linear RGB).
Paint PaintMesh(const Eigen::Vector3d& point_mm, const Eigen::Vector3f& base, uint64_t seed);

}  // namespace lfm
