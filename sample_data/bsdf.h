// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>

#include "sample_data/material.h"

namespace lfm {

/// How a Material scatters light. Directions are unit vectors that point away from the surface, in
/// a frame whose z is the shading normal and x the tangent; `o` goes back along the path (to the
/// eye), `i` on along it (to the light). z < 0 is inside a kGlass; everything else is opaque and
/// must be asked with oz > 0 (with oz <= 0 it returns black).
///
/// kLambert    rho / pi
/// kPhong      kd / pi + ks (s + 2) / (2 pi) cos^s(angle of i with the mirror image of o): the
///             modified lobe of Lafortune and Willems 1994, whose albedo is exactly ks at normal
///             incidence and less elsewhere (what lies below the horizon is lost)
/// kConductor  Schlick(specular) D G2 / (4 cos cos), GGX (sample_data/lanes/microfacet.h); light
///             scattered twice between facets is lost
/// kPaint      diffuse (1 - specular) / pi + the same coat, isotropic: what light_baking and
///             coat_shading compute
/// kPlastic    GGX with the exact Fresnel term over a base that gets what the coat leaves
///             (sample_data/layer_albedo.h)
/// kGlass      Walter, Marschner, Li and Torrance 2007 (their equations 20 and 21), alpha_u on both
///             axes. Radiance is physical: refraction scales it by (n_o / n_i)^2, which undoes
///             itself when the ray comes out. Absorption is the path tracer's.
/// kFuzz       specular times fibres (sample_data/lanes/fuzz.h) over a base that gets what they
/// leave
///
/// A conductor, a coat or a glass of roughness below kMirrorAlpha is perfectly smooth: a delta
/// lobe, which only SampleBsdf sees. A rough glass whose index is within 1e-3 of 1 counts as clear.
inline constexpr float kMirrorAlpha = 1e-3f;

/// The BSDF times |cos i|, without delta lobes, and the density (1/sr) with which SampleBsdf
/// draws `i` given `o`.
struct BsdfValue {
  Eigen::Vector3f value = Eigen::Vector3f::Zero();
  float density = 0;
};
BsdfValue EvaluateBsdf(const Material& material, const Eigen::Vector3f& o,
                       const Eigen::Vector3f& i);

/// A direction drawn in proportion (nearly) to the BSDF times the cosine.
struct BsdfSample {
  Eigen::Vector3f direction = {0, 0, 1};
  /// BSDF |cos i| / density: what the incident radiance is multiplied by. Zero: nothing drawn.
  Eigen::Vector3f weight = Eigen::Vector3f::Zero();
  float density = 0;       ///< 1/sr, of all lobes together; 0 for a delta lobe
  bool delta = false;      ///< drawn from a delta lobe
  float index_ratio2 = 1;  ///< (n_i / n_o)^2: what `weight` lacks for energy to be conserved
};
/// `u_lobe` picks the lobe, `u1` and `u2` the direction, all uniform in [0, 1).
BsdfSample SampleBsdf(const Material& material, const Eigen::Vector3f& o, float u_lobe, float u1,
                      float u2);

/// True when the material has delta lobes only: nothing but SampleBsdf can find its light.
bool IsDelta(const Material& material);

/// Throws Error, naming `where`, unless colours and roughnesses lie in [0, 1], exponent and
/// absorption are not negative, the index lies in [0.2, 5], and every number is finite.
void ValidateMaterial(const Material& material, const std::string& where);

}  // namespace lfm
