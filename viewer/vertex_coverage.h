// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "core/progress.h"
#include "core/triangle_mesh.h"
#include "viewer/camera_file.h"

namespace lfm {

/// How many of the cameras see each vertex: it projects onto the sensor, one of its triangles faces
/// the camera by less than 80 degrees (the angle at the vertex from the triangle's normal to the
/// eye), and nothing of the mesh lies before it, but for 1e-5 of the mesh's extent. Visibility in
/// resample/ is stricter: it asks for whole triangles. Vertices without a triangle are seen by
/// nobody.
///
/// Parallel over vertices, the progress counts them; the result does not depend on the number of
/// threads. Throws Error when the mesh has no triangle, an index out of range or a coordinate that
/// is not finite.
std::vector<int> CountPhotographs(const TriangleMesh& mesh, std::span<const PosedCamera> cameras,
                                  Progress& progress);

}  // namespace lfm
