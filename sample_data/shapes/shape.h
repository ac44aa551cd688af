// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "core/triangle_mesh.h"
#include "sample_data/paint.h"

namespace lfm {

/// What a generator makes: a mesh in its own frame (mm, z up, facing -y, outward normals).
struct Shape {
  TriangleMesh mesh;
  std::vector<Eigen::Vector2f> uv;  ///< a vertex, in [0, 1]; empty when the shape has none
  std::vector<Paint> paint;         ///< a vertex; empty when the shape has no paint of its own
};

/// Adds `other`, moved by `offset`; uv and paint are kept where both have them. An empty `shape`
/// takes over everything.
void AppendShape(Shape& shape, const Shape& other, const Eigen::Vector3d& offset);

/// Throws Error when a shape would have more than 4 million triangles (`triangles` is an estimate).
void RequireTriangleCount(double triangles);

/// A body given by a function (negative inside) over the box from `min` to `max`, polygonised with
/// edges of about `edge_mm` (sample_data/isosurface.h): closed, with exact normals. The grid is a
/// little larger than the box, and tried at four positions. Separate pieces of less than four cells
/// and cavities are dropped. `max_gradient` bounds the function's
/// gradient. Throws Error where PolygoniseIsosurface does at all of them, and for more than 400
/// million cells.
Shape PolygoniseShape(const std::function<double(const Eigen::Vector3d&)>& function,
                      const Eigen::Vector3d& min, const Eigen::Vector3d& max, double edge_mm,
                      double max_gradient);

/// Gives every vertex the paint of its position, and the mesh the paint's diffuse colours.
void PaintShape(Shape& shape, const std::function<Paint(const Eigen::Vector3d&)>& paint);

}  // namespace lfm
