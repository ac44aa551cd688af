// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "mesh/mesh.h"

namespace lfm {

/// Writes `folder/surface.ply`, `folder/mesh.ply` and `folder/mesh.json` (figures).
void SaveMesh(const MeshResult& result, const std::filesystem::path& folder);
MeshResult LoadMesh(const std::filesystem::path& folder);

}  // namespace lfm
