// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/progress.h"
#include "core/triangle_mesh.h"

namespace lfm {

/// The part of each triangle, from 0 in the order of their first triangles; triangles that share a
/// vertex, or are connected through such, are of one part.
std::vector<int> LabelParts(const TriangleMesh& mesh);

struct PartUnion {
  TriangleMesh mesh;  ///< vertices and triangles only
  int united = 0;     ///< parts of the given mesh that are one with others now
};

/// The outer surface of a mesh that is put together from closed parts which cross each other, as
/// modelled objects are: parts whose triangles meet become the union of their volumes (CGAL, exact
/// constructions). What lies inside another part of them goes; joints become edges. Coordinates are
/// rounded to doubles at the end, and corners that lie within a billionth of the size become one;
/// now and then rounding leaves a sliver that crosses its neighbour.
///
/// Parts stay as they are where they meet no other, and where no union is defined: beside an open
/// part, one with a triangle without area, one that encloses no positive volume (a cavity, a part
/// that is inside out), one that crosses itself so that it cannot be parted by moves of a
/// thousandth of its size (RemoveSelfIntersections), or where the union is no manifold. Nothing is
/// returned when that is all parts. Time grows with the triangles of the parts that meet, times the
/// logarithm of their number. Throws Error for an invalid mesh or one that is no oriented manifold.
std::optional<PartUnion> UniteParts(const TriangleMesh& mesh, Progress& progress);

}  // namespace lfm
