// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace lfm {

/// The microfacet coat of the studio's paint: the isotropic GGX distribution with Smith's
/// height-correlated masking and Schlick's Fresnel term.
///
///   f(v, l) = F(v.h) D(h) G2(v, l) / (4 (n.v) (n.l)),   h = (v + l) / |v + l|
///
/// Sources: Walter et al. 2007 (D, G1), Heitz 2014 (G2), Schlick 1994 (F). Directions are unit, in
/// a local frame whose z is the normal; `alpha` is the roughness in (0, 1]. Every function returns
/// 0 for directions at or below the horizon, never NaN.

/// D(h), 1/sr, for cosine `cos_h` of the half vector with the normal.
double GgxDistribution(double cos_h, double alpha);
/// Smith's G1 for one direction.
double GgxMasking(double cos_v, double alpha);
/// D G2 / (4 (n.v)(n.l)): the BRDF for F = 1, 1/sr.
double GgxReflection(const Eigen::Vector3d& v, const Eigen::Vector3d& l, double alpha);
/// Schlick's approximation: f0 + (1 - f0) (1 - cos)^5; `cos_vh` is clamped to [0, 1].
double SchlickFresnel(double f0, double cos_vh);

/// Half vector drawn from the distribution of normals visible from `v` (Heitz 2018), from two
/// uniform numbers; the reflected direction is 2 (v.h) h - v.
Eigen::Vector3d SampleVisibleNormal(const Eigen::Vector3d& v, double alpha, double u1, double u2);
/// Density of the reflected direction of SampleVisibleNormal, 1/sr.
double VisibleNormalReflectionDensity(const Eigen::Vector3d& v, const Eigen::Vector3d& l,
                                      double alpha);

/// What the coat does with smooth light, for one roughness and view angle: reflected radiance is
/// (scale f0 + bias) times the incident radiance averaged over a lobe round `mean`, whose zonal
/// harmonics are attenuated by `zonal` (band 0 to 4).
struct CoatLobe {
  double scale = 0, bias = 0;         ///< directional albedo = scale f0 + bias (split sum)
  double mean_sin = 0, mean_cos = 1;  ///< mean direction, opposite to v's azimuth
  double zonal[5] = {1, 0, 0, 0, 0};  ///< E[P_l(cos of the angle to the mean direction)]
};
/// Integrates CoatLobe by 4096 samples of SampleVisibleNormal on a lattice.
CoatLobe IntegrateCoatLobe(double cos_v, double alpha);

/// CoatLobe tabulated over alpha in [0.1, 0.5] and cos_v in [0, 1], interpolated bilinearly;
/// arguments outside are clamped.
class CoatLobeTable {
 public:
  CoatLobeTable();
  CoatLobe Lookup(double cos_v, double alpha) const;

 private:
  std::vector<CoatLobe> lobes_;
};

}  // namespace lfm
