// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace lfm {

/// Triangles that fill closed contours in the plane: indices into `points`. Each contour is a list
/// of indices with the filled side on its left; nested contours bound holes (even-odd rule). Points
/// in no contour become corners where they lie inside. The triangulation is constrained Delaunay,
/// counter-clockwise. Contours that touch or cross themselves or each other are filled by one fan
/// each instead: every edge of a contour still has its triangle, but triangles may overlap.
std::vector<Eigen::Vector3i> FillContours(const std::vector<Eigen::Vector2d>& points,
                                          const std::vector<std::vector<int>>& contours);

}  // namespace lfm
