// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "encode/light_field_source.h"

namespace lfm {

/// What the surroundings look like in the object, and how much each triangle shows of it:
///
///   colour of triangle t towards d, mean of its samples ~ mean_t + gain[t] light(r),
///   r = 2 (n . d) n - d  (d to the eye, n the triangle's smoothed normal; Wood 2000; Mahajan 2007,
///   Equation 14)
///
/// sRGB-coded. Each photograph sees a highlight from one side alone; all triangles together see it
/// from everywhere, so the light between and outside the directions of one triangle's photographs
/// is known from the others'.
struct ReflectionModel {
  int side = 64;
  std::vector<Eigen::Vector3f> light;  ///< side x side, octahedral map of the sphere; 0 unseen
  std::vector<float> gain;             ///< T, in [0, 3]; 0 where the light explains nothing

  /// Bilinear, for a unit direction in the world.
  Eigen::Vector3f LightAt(const Eigen::Vector3d& direction) const;
};

/// Fits light and gains in turn, by least squares with small ridges, to the mean colours of all
/// triangles in all their photographs; six photographs at least for a triangle to take part.
/// `source.eyes` must be there (Error if not one a photograph). Deterministic; never NaN for finite
/// values. Diffuse objects get light and gains near zero.
ReflectionModel FitReflections(const LightFieldSource& source);

/// The source with `change` set: blends of photographs in a direction d change by what the model
/// says of d and of the directions of the photographs that are blended,
///
///   gain[t] (light(r(d)) - sum over blended photographs i of weight_i light(r_i)).
///
/// In a photograph's own direction nothing changes. The new source holds the model.
LightFieldSource WithReflections(const LightFieldSource& source, ReflectionModel model);

}  // namespace lfm
