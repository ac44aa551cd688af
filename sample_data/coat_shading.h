// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "sample_data/ggx.h"
#include "sample_data/light_baking.h"
#include "sample_data/lighting.h"
#include "sample_data/subject.h"

namespace lfm {

/// Positions of all lamp cells in columns, for the coat's inner loop.
struct LampCells {
  int count = 0;
  alignas(64) float x[kMaxLights * kLightCells] = {}, y[kMaxLights * kLightCells] = {};
  alignas(64) float z[kMaxLights * kLightCells] = {};
  /// Unit normal of each cell's lamp and the cell's area, mm^2.
  alignas(64) float nx[kMaxLights * kLightCells] = {}, ny[kMaxLights * kLightCells] = {};
  alignas(64) float nz[kMaxLights * kLightCells] = {}, area[kMaxLights * kLightCells] = {};
};
LampCells MakeLampCells(const Lighting& lighting);

/// Everything that the coat's shading reads; references stay valid as long as their owners.
struct CoatShading {
  CoatShading(const Subject& subject_in, const Lighting& lighting_in, const BakedLight& light_in)
      : subject(subject_in),
        lighting(lighting_in),
        light(light_in),
        cells(MakeLampCells(lighting_in)) {}

  const Subject& subject;
  const Lighting& lighting;
  const BakedLight& light;
  LampCells cells;
  CoatLobeTable lobes;
};

/// Radiance that the coat sends from the object's hit to `eye`: the lamps by GGX over their cells
/// (times the baked share that is seen), surroundings and interreflection by the coat's lobe over
/// the baked harmonics. `to_eye` is unit, world frame. Zero when seen from behind.
Eigen::Vector3f CoatRadiance(const CoatShading& shading, const SurfaceHit& hit,
                             const Eigen::Vector3f& point, const Eigen::Vector3f& to_eye);

/// Radiance of the diffuse base at the hit.
Eigen::Vector3f BaseRadiance(const CoatShading& shading, const SurfaceHit& hit);

/// For each lamp cell, per unit radiance: what GGX reflects towards `v` at (point, n), split into
/// the part that the coat's f0 scales and the rest (Fresnel's rise), times `visibility`. Arrays are
/// `cells.count` long.
void ReflectLampCells(const LampCells& cells, const Eigen::Vector3f& point,
                      const Eigen::Vector3f& n, const Eigen::Vector3f& v, float alpha,
                      const float* visibility, float* scale, float* bias);

}  // namespace lfm
