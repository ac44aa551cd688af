// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "sample_data/lighting.h"
#include "sample_data/studio_scene.h"

namespace lfm {

/// Share of each lamp cell seen from a point (kLightCells a lamp, each in [0, 1]), 0 for all cells
/// of a lamp that is wholly behind the surface; and the irradiance they give together.
struct LampLight {
  float visibility[kMaxLights * kLightCells] = {};
  Eigen::Vector3f irradiance = Eigen::Vector3f::Zero();
  int64_t rays = 0;  ///< that were asked
};
/// Asks `rays_per_cell` shadow rays (rounded to a square) a cell, one where the lamp's cells agree.
LampLight GatherLamps(const StudioScene& scene, const Lighting& lighting,
                      const Eigen::Vector3f& point, const Eigen::Vector3f& normal,
                      int rays_per_cell);

/// Irradiance at the point by each of the lamp's cells, in full view and of unit radiance, into
/// form[kLightCells]: cosines over squared distance times the cell's area. Returns their sum.
float LampForms(const AreaLight& light, const Eigen::Vector3f& point, const Eigen::Vector3f& normal,
                float* form);

}  // namespace lfm
