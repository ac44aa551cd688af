// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>

#include "core/triangle_mesh.h"

namespace lfm {

/// A box and the cell size of the grid that an implicit function is polygonised on, mm.
struct IsosurfaceGrid {
  Eigen::Vector3d min, max;
  double cell_mm = 1;
};

/// Polygonises { function = 0 } (negative inside) by dual surface nets (Gibson 1998; one vertex for
/// each sheet in a cell, Nielson 2004), relaxed along the surface and projected onto it by Newton
/// steps; unit normals are the function's gradient there. Edges are about one cell long.
///
/// The mesh is closed when the surface lies inside the box, and a 2-manifold when the cells resolve
/// it. `max_gradient` bounds the function's gradient: whole blocks of cells farther away than that
/// allows are skipped. Throws Error when the surface leaves the box, when nothing is inside, or
/// when the result is no closed 2-manifold (choose smaller cells).
TriangleMesh PolygoniseIsosurface(const std::function<double(const Eigen::Vector3d&)>& function,
                                  const IsosurfaceGrid& grid, double max_gradient);

}  // namespace lfm
