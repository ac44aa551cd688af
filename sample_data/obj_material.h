// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace lfm {

/// The diffuse colour of an OBJ file's material; all else that a material library says is left out.
struct ObjMaterial {
  std::string name;
  Eigen::Vector3f diffuse = {0.8f, 0.8f, 0.8f};  ///< `Kd`, taken as linear
  std::filesystem::path picture;                 ///< `map_Kd`; empty: none
};

/// Reads a Wavefront material library (.mtl): `newmtl`, `Kd` with three numbers (or one, for gray;
/// clamped to [0, 1]), `map_Kd` with its options skipped and a file name that may hold spaces,
/// relative to the library's folder, backslashes taken as slashes. Throws Error (file, line, cause)
/// for a missing file, binary content, a statement before the first `newmtl`, and a colour that is
/// missing or not finite.
std::vector<ObjMaterial> ReadObjMaterials(const std::filesystem::path& file);

}  // namespace lfm
