// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/triangle_mesh.h"
#include "mesh/surface_distance.h"

namespace lfm {

/// Moves the vertices v_i along their normals m_i by the d_i that minimise
///   sum_k (n_k . (p_k - q_k) - sum_j b_kj d_j n_k . m_j)^2 + lambda sum_i d_i^2
/// over samples p_k of the surface, whose closest point on the mesh is q_k, with barycentric
/// weights b_kj, on a triangle with normal n_k. Samples whose normal points elsewhere (more than 60
/// degrees from n_k) do not count. Moves that would turn a triangle by more than 45 degrees are
/// held back.
/// `fixed` (a flag a vertex, or empty) stay.
TriangleMesh FitToSurface(const TriangleMesh& mesh, const SurfaceSamples& samples,
                          const std::vector<char>& fixed);

}  // namespace lfm
