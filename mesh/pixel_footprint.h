// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calib/calib.h"
#include "core/ray_scene.h"
#include "core/triangle_mesh.h"

namespace lfm {

/// Size of a photograph's pixel at the object, mm: the median of depth / focal length over points
/// spread over the surface and the train photographs that see them; test photographs have no say.
/// Throws Error when there is no train photograph, or none sees the object.
double MedianPixelFootprint(const TriangleMesh& surface, const RayScene& scene,
                            const CalibResult& calib);

}  // namespace lfm
