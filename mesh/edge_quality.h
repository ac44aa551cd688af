// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/ray_scene.h"
#include "core/triangle_mesh.h"
#include "mesh/surface_distance.h"

namespace lfm {

/// Gives a decimated mesh well-shaped triangles and the best fit to the surface it comes from, in
/// turns of three steps, same number of triangles throughout:
///  - edge flips that raise the smallest angle of the two triangles (and so lead towards a Delaunay
///    mesh), except at creases of more than 45 degrees;
///  - tangential smoothing: a vertex goes halfway to the centroid of its ring, then to the closest
///    point of the surface, if that raises the smallest angle around it;
///  - a least-squares fit of all vertices along their normals (FitToSurface).
/// Vertices at creases and boundaries stay. `samples` lie on the surface, `surface` is a scene of
/// it. Vertices and triangles only.
TriangleMesh ImproveTriangles(const TriangleMesh& mesh, const RayScene& surface,
                              const SurfaceSamples& samples);

/// The first step alone. Vertices and triangles only.
TriangleMesh FlipTowardsDelaunay(const TriangleMesh& mesh);

}  // namespace lfm
