// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/triangle_mesh.h"
#include "sample_data/mesh_import.h"
#include "sample_data/paint.h"

namespace lfm {

/// What stands on the platform: a fine mesh with normals, and the paint at each vertex. World
/// frame, mm; the lowest point has z = 0.
struct Subject {
  TriangleMesh mesh;
  std::vector<Paint> paint;  ///< one a vertex
};

/// The bust (sample_data/bust_shape.h), polygonised with edges of about `edge_mm`.
Subject MakeBust(double edge_mm, uint64_t seed);

/// A mesh brought along: centred over the platform, its lowest point set on z = 0, scaled to
/// `height_mm` (less when it would be wider than 130 mm), and its edges split until none is longer
/// than `edge_mm`, since light is baked at vertices. Its vertex colours, or its materials' colours
/// and pictures as they are at the vertices after splitting, become the base colour.
/// Throws Error for a flat mesh (no height), one that needs more than 4 million triangles, and a
/// material's picture that cannot be read.
Subject MakeSubject(ImportedMesh imported, double height_mm, double edge_mm, uint64_t seed);

/// Splits every edge longer than `edge_mm` in the middle until none is; neighbours stay joined.
/// Colours, normals, texture coordinates and confidence are interpolated; a new vertex has the
/// material of an end (both ends of a triangle's edge have the same).
ImportedMesh SplitLongEdges(ImportedMesh imported, double edge_mm);

}  // namespace lfm
