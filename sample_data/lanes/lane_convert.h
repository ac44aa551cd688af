// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "sample_data/lanes/lane_bsdf.h"
#include "sample_data/material.h"

namespace lfm {

/// Between the vectors of one path and Eigen's. Not for files that are compiled for several
/// instruction sets.
inline Vec<float> ToLane(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }
inline Eigen::Vector3f FromLane(const Vec<float>& v) { return {v.x, v.y, v.z}; }

inline LaneMaterial<float> ToLane(const Material& m) {
  LaneMaterial<float> lane;
  lane.kind = static_cast<int32_t>(m.kind);
  lane.diffuse = ToLane(m.diffuse);
  lane.specular = ToLane(m.specular);
  lane.exponent = m.exponent;
  lane.alpha_u = m.alpha_u;
  lane.alpha_v = m.alpha_v;
  lane.ior = m.ior;
  lane.absorption = ToLane(m.absorption_per_mm);
  return lane;
}

}  // namespace lfm
