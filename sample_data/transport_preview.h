// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/cube_map.h"
#include "core/image.h"
#include "sample_data/fixed_view.h"
#include "sample_data/traced_scene.h"

namespace lfm {

/// Radiance a texel of the cube map, of a dim room with a bright window, up to the left of the eye.
std::vector<float> PreviewLight(const CubeMap& cube);

/// The first view of a transport mesh under some light: a pinhole picture of the scene, the
/// radiance of its vertices interpolated over triangles; 2 x 2 rays a pixel. `radiance` has one
/// value a vertex, the objects one after the other. What no object covers is mid gray.
Image PreviewMesh(const TracedScene& scene, const FixedView& view,
                  std::span<const Eigen::Vector3f> radiance);

}  // namespace lfm
