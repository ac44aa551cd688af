// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "fields/field.h"

namespace lfm {

struct LightCellOptions {
  /// Directions further than this from every light belong to none, degrees in (0, 180]. 0: where
  /// the lights surround the scene nothing is cut; else what lies neither between lights (in a
  /// triangle of LightTriangulation) nor within its median radius of one. So light from below a
  /// dome is left out instead of lumped onto the lights at its rim.
  double max_angle_deg = 0;
};

/// To which light each direction belongs: the angular Voronoi diagram (Masselus 2002, as in Yamada
/// 2009, Section 4), for texels of a cube map the texels themselves. Made once for a set of lights.
struct LightCells {
  /// A stretch of a row of kProbeRows x kColumns directions (fields/light_probe.h), to the next
  /// one's begin; the last ends at kColumns.
  struct Run {
    int begin = 0, light = -1;  ///< -1: no light's
  };
  static constexpr int kColumns = 1024;
  static constexpr int kFace = 128;  ///< texels a side of a face of `cube_light`

  FieldColumns kind = FieldColumns::kLights;
  int cube_resolution = 0;  ///< of kCubeTexels
  std::vector<Eigen::Vector3d> directions;
  std::vector<double> solid_angle;  ///< sr, a light
  std::vector<Run> runs;
  std::vector<int> first_run;   ///< kProbeRows + 1
  std::vector<int> cube_light;  ///< a texel of a cube of kFace (core/cube_map.h); -1: none
};

/// Of equally near lights, the first one's. Throws Error for kViews, without directions, when one
/// is not of unit length, when kCubeTexels are not 6 N^2 in number, or the angle is out of range.
LightCells MakeLightCells(FieldColumns kind, const std::vector<Eigen::Vector3d>& directions,
                          const LightCellOptions& options = {});

}  // namespace lfm
