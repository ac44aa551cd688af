// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "core/point_cloud.h"
#include "core/triangle_mesh.h"

namespace lfm {

/// Reads a PLY mesh: ascii, binary little or big endian; polygons are fanned into triangles;
/// properties x y z, nx ny nz, confidence (or quality), red green blue; others are skipped.
/// Throws Error on truncated, oversized, inconsistent or non-finite content.
TriangleMesh ReadPlyMesh(const std::filesystem::path& file);
/// Texture coordinates a vertex: properties s t, u v or texture_u texture_v; empty when there are
/// none. Throws Error as ReadPlyMesh does.
std::vector<Eigen::Vector2f> ReadPlyTextureCoordinates(const std::filesystem::path& file);
/// Reads the vertices of a PLY file as a cloud, with `sigma_mm` when there is such a property
/// (Error where it is not positive); faces are ignored. An empty cloud is no error here.
PointCloud ReadPlyCloud(const std::filesystem::path& file);

/// Writes binary little-endian PLY atomically: float64 coordinates (clouds: float32), float32
/// normals, confidence and sigma_mm (clouds), 8-bit colours.
void WritePly(const TriangleMesh& mesh, const std::filesystem::path& file);
void WritePly(const PointCloud& cloud, const std::filesystem::path& file);

}  // namespace lfm
