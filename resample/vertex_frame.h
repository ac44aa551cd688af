// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace lfm {

/// The frame of a vertex with unit normal z whose x axis follows `edge`: its projection, or that of
/// the world axis least along z where the edge is zero or parallel to z. Columns x, y, z,
/// right-handed and orthonormal.
Eigen::Matrix3d VertexFrame(const Eigen::Vector3d& z, const Eigen::Vector3d& edge);

}  // namespace lfm
