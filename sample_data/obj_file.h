// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "core/triangle_mesh.h"
#include "sample_data/obj_material.h"

namespace lfm {

/// A mesh with texture coordinates and a material a vertex.
struct TexturedMesh {
  TriangleMesh mesh;
  std::vector<Eigen::Vector2f> uv;     ///< empty when the file has none
  std::vector<int> material;           ///< index into `materials`, -1: none; empty without any
  std::vector<ObjMaterial> materials;  ///< what the file's libraries say
  std::vector<std::string> warnings;   ///< what of the materials was left out, a line each
};

/// Reads a Wavefront OBJ file: `v` (with or without colours), `vt`, `vn` and `f`, absolute or
/// relative indices, polygons fanned into triangles, `mtllib` and `usemtl` (obj_material.h); all
/// other statements (groups, lines, curves) are skipped. A corner that pairs a position with other
/// texture coordinates, another normal or another material than before becomes a vertex of its own;
/// uv and normals are kept only when every corner has them. Positions that no face names are left
/// out. Lines may be continued by a backslash. A library that is not there, or a material that none
/// has, is a warning.
///
/// Throws Error (file, line, cause) for a number that is none, not finite or missing, an index out
/// of range, a face of fewer than three corners, a file without faces, and text that is not OBJ.
TexturedMesh ReadObj(const std::filesystem::path& file);

}  // namespace lfm
