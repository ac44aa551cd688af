// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/ray_scene.h"
#include "core/triangle_mesh.h"

namespace lfm {

/// True when it is proven that no point of `mesh` lies farther than `max_mm` from `other`, of which
/// `scene` is a scene.
///
/// The distance to one triangle is convex: on a piece of a triangle of `mesh` it is largest at a
/// corner. So a piece is near enough when one triangle of `other` is near enough to its three
/// corners; those tried are the nearest to its middle and to its corners. Other pieces are cut in
/// four. False when a corner or middle is too far, and when pieces smaller than a fiftieth of
/// `max_mm` are still undecided: distances within 2 % of the bound may be refused, none beyond it
/// is accepted. Throws Error for an invalid mesh.
bool IsWithin(const TriangleMesh& mesh, const TriangleMesh& other, const RayScene& scene,
              double max_mm);

/// Distance of a point from a triangle with corners a, b, c, mm; a needle or a point counts as the
/// segment or point that it is.
double DistanceToTriangle(const Eigen::Vector3d& point, const Eigen::Vector3d& a,
                          const Eigen::Vector3d& b, const Eigen::Vector3d& c);

}  // namespace lfm
