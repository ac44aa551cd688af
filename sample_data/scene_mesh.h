// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/triangle_mesh.h"
#include "sample_data/scene_description.h"

namespace lfm {

/// All objects as one mesh, vertices and triangles in the objects' order, with normals, coloured
/// (sRGB) by the diffuse albedo, textures and paint applied. No object: an empty mesh.
TriangleMesh JoinObjects(const std::vector<SceneObject>& objects);

}  // namespace lfm
