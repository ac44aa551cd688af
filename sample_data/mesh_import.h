// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "core/triangle_mesh.h"
#include "sample_data/obj_material.h"

namespace lfm {

/// A mesh that was brought along, cleaned.
struct ImportedMesh {
  TriangleMesh mesh;                   ///< with unit normals
  std::vector<Eigen::Vector2f> uv;     ///< a vertex; empty when the file has none
  std::vector<int> material;           ///< a vertex, into `materials` (-1: none); may be empty
  std::vector<ObjMaterial> materials;  ///< of an OBJ file's libraries
  std::vector<std::string> warnings;   ///< one line each: what was repaired, what to know
};

/// Reads a PLY or OBJ mesh (by content: a PLY file begins with "ply") for rendering, in the file's
/// own units and frame.
///
/// Repaired, with a warning: triangles of no area (repeated corners, or a height below 1e-12 of the
/// mesh's size) and vertices of no triangle are dropped; missing or zero normals are computed.
/// Holes and edges of more than two triangles stay, with a warning that counts them. At an edge
/// where uv or normals differ, and which is therefore no edge of one mesh, positions are compared.
///
/// Throws Error (file, cause): a file that is missing, empty, truncated or no mesh; a coordinate
/// that is not finite (naming the vertex); an index out of range; a mesh without triangles, also
/// when none is left; a coordinate beyond 1e9 or an extent below 1e-9; more than 4 million
/// triangles.
ImportedMesh ImportMesh(const std::filesystem::path& file);

/// Colours (sRGB, a vertex) by materials: the diffuse colour times its picture at the vertex's
/// texture coordinates. Vertices without a material are 0.8 gray (linear, as OBJ's default). The
/// mesh's own colours, which are finer, when it has any; nothing when it has neither. Without
/// texture coordinates pictures are left out. Throws Error (file) for a picture that is missing or
/// no picture.
std::vector<Eigen::Vector3f> MaterialColors(const ImportedMesh& imported);

}  // namespace lfm
