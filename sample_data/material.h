// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace lfm {

/// What a surface does with light.
enum class MaterialKind {
  kLambert,    ///< `diffuse`
  kPhong,      ///< `diffuse` and the modified Phong lobe `specular`, `exponent`, exactly
  kConductor,  ///< GGX metal: `specular` at normal incidence, `alpha_u`, `alpha_v`; a mirror at 0
  kPaint,      ///< metallic paint: `diffuse` under a GGX coat `specular`, as sample_data/paint.h
  kPlastic,    ///< `diffuse` under a GGX dielectric of index `ior`
  kGlass,      ///< dielectric that refracts: `ior`, `alpha_u`, `absorption_per_mm`; clear at 0
  kFuzz,       ///< `diffuse` under a sheen of short fibres: `specular` its colour, `alpha_u`
};

/// A material at one point of a surface, every texture applied. Colours are linear.
struct Material {
  MaterialKind kind = MaterialKind::kLambert;
  Eigen::Vector3f diffuse = {0.5f, 0.5f, 0.5f};   ///< albedo of the diffuse base
  Eigen::Vector3f specular = {0, 0, 0};           ///< see MaterialKind
  float exponent = 50;                            ///< kPhong: of the cosine, any >= 0
  float alpha_u = 0.3f, alpha_v = 0.3f;           ///< GGX roughness along the tangent and across it
  float ior = 1.5f;                               ///< inside against outside
  Eigen::Vector3f absorption_per_mm = {0, 0, 0};  ///< kGlass: Beer-Lambert
};

}  // namespace lfm
