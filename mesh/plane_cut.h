// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/triangle_mesh.h"

namespace lfm {

/// Cuts a closed manifold mesh at the plane z = 0, keeps what lies above, and closes it by a flat
/// cap, made of the contour and of points in between about two `spacing_mm` apart. Vertices nearer
/// to the plane than a tenth of `spacing_mm` are first moved to that distance, so that no vertex
/// lies in the plane and the cut leaves no slivers. Only vertices and triangles are returned. A
/// mesh that lies above the plane comes back as it is; one below it comes back empty. Throws Error
/// when the mesh is not closed where the plane cuts it.
TriangleMesh CutAtPlatform(const TriangleMesh& mesh, double spacing_mm);

}  // namespace lfm
