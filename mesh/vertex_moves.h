// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/triangle_mesh.h"

namespace lfm {

/// Vertices moved by `moves[v]` mm along the unit `directions[v]`. Moves that would turn one of
/// their triangles by more than 45 degrees are halved until none does; those that still would are
/// dropped. Moves must be finite.
std::vector<Eigen::Vector3d> MoveWithoutFlips(const TriangleMesh& mesh,
                                              const std::vector<Eigen::Vector3d>& directions,
                                              Eigen::VectorXd moves);

}  // namespace lfm
