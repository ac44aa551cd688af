// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "sample_data/shapes/shape.h"

namespace lfm {

/// A box that stands on z = 0 round the z axis: `size` in x, y and z (mm), its edges cut off by
/// `bevel` and shaded round. Faces are divided into squares of about `edge_mm`; uv runs over each
/// face. Closed. Throws Error unless 0 < 2 bevel < the smallest size.
Shape MakeBox(const Eigen::Vector3d& size, double bevel, double edge_mm);

/// A wall bent round the z axis, centred on +y and standing on z = 0: inner and outer radius,
/// height (mm), and the angle that it covers (rad, below 2 pi). Divided and bevelled like a box.
Shape MakeRingWall(double inner_radius, double outer_radius, double height, double angle,
                   double bevel, double edge_mm);

/// An open sheet in the plane z = 0, facing +z, round the z axis: `width` along x, `depth` along y,
/// divided into squares of about `edge_mm`. uv (0, 0) lies at -x, -y.
Shape MakeSheet(double width, double depth, double edge_mm);

/// `count` x `count_y` boxes in rows, round the z axis, `pitch` (x, y) apart: a grid of blockers
/// (Mahajan 2007, Figure 7e). Long boxes in one row make the one-dimensional grid.
Shape MakeBlockers(int count_x, int count_y, const Eigen::Vector3d& size,
                   const Eigen::Vector2d& pitch, double bevel, double edge_mm);

}  // namespace lfm
