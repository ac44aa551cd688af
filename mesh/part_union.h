// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "core/triangle_mesh.h"

namespace lfm {

/// The outer surface of a mesh that is put together from closed parts which cross each other, as
/// modelled objects are: the union of the parts' volumes (CGAL, exact constructions; coordinates
/// are rounded to doubles at the end). What lies inside another part goes; joints become edges. A
/// part that crosses itself is parted first (RemoveSelfIntersections). Vertices and triangles only.
///
/// Nothing where there is nothing to unite, or where no union is defined: a mesh of one part, an
/// open part, one that encloses no positive volume (a cavity), one whose own crossings cannot be
/// parted, or a union that is no manifold. Throws Error for an invalid mesh.
std::optional<TriangleMesh> UniteParts(const TriangleMesh& mesh);

}  // namespace lfm
