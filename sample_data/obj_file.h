// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "core/triangle_mesh.h"

namespace lfm {

/// A mesh with texture coordinates a vertex.
struct TexturedMesh {
  TriangleMesh mesh;
  std::vector<Eigen::Vector2f> uv;  ///< empty when the file has none
};

/// Reads a Wavefront OBJ file: `v` (with or without colours), `vt`, `vn` and `f`, absolute or
/// relative indices, polygons fanned into triangles; all other statements (groups, materials,
/// lines, curves) are skipped. A corner that pairs a position with other texture coordinates or
/// another normal than before becomes a vertex of its own; uv and normals are kept only when every
/// corner has them. Positions that no face names are left out. Lines may be continued by a
/// backslash.
///
/// Throws Error (file, line, cause) for a number that is none, not finite or missing, an index out
/// of range, a face of fewer than three corners, a file without faces, and text that is not OBJ.
TexturedMesh ReadObj(const std::filesystem::path& file);

}  // namespace lfm
