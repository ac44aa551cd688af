// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "encode/light_field_source.h"

namespace lfm {

/// What the surroundings look like in the object, as surfaces of one or several kinds show them,
/// and how much each triangle shows of each:
///
///   colour of triangle t towards d ~ mean_t + sum over lights k of gain[t][k] light_k(r),
///   r = 2 (n . d) n - d  (d to the eye, n the smoothed normal; Wood 2000; Mahajan 2007, Equation
///   14)
///
/// sRGB-coded. Each photograph sees a highlight from one side alone; all triangles together see it
/// from everywhere, so the light between and outside the directions of one triangle's photographs
/// is known from the others'. One light serves surfaces that are equally rough; mixtures of several
/// make blurs and tints between them.
struct ReflectionModel {
  using Light = std::vector<Eigen::Vector3f>;  ///< side x side, octahedral map of the sphere
  static constexpr int kMostLights = 4;

  int side = 32;
  std::vector<Light> lights;  ///< 0 where nobody looks
  /// `gain[t * lights.size() + k]`; 0 where the lights explain nothing. One light: in [0, 3];
  /// several: in [-3, 3].
  std::vector<float> gain;

  /// What triangle t shows towards each mirror direction, without its mean.
  Light ShownBy(int triangle) const;
};

/// Bilinear, for a direction in the world (of any length; without one: from above).
Eigen::Vector3f LookUp(const ReflectionModel::Light& light, int side,
                       const Eigen::Vector3d& direction);

/// Fits lights and gains in turn, by least squares with small ridges, to the hat-weighted mean
/// colours at the three corners of triangles in all their photographs; six photographs at least for
/// a triangle to take part. The lights come from 20 000 triangles at most, spread over the mesh (so
/// many that all photographs would show 4 million; 1000 at least), so that time and memory stay
/// bounded; gains are fitted for all.
///
/// `lights` in [1, kMostLights] (Error). `source.eyes` must be there (Error if not one a
/// photograph). Deterministic; never NaN for finite values. Diffuse objects get light and gains
/// near zero.
ReflectionModel FitReflections(const LightFieldSource& source, int lights = 3);

/// The source with `change` set: blends of photographs in a direction d change by what the model
/// says of d and of the directions of the photographs that are blended, with the normal n_c of each
/// corner c, and between the corners linearly:
///
///   sum over corners c of hat_c (shown(r_c(d)) - sum over blended photographs i of weight_i
///   shown(r_c(d_i)))
///
/// In a photograph's own direction nothing changes. The new source holds the model.
LightFieldSource WithReflections(const LightFieldSource& source, ReflectionModel model);

}  // namespace lfm
