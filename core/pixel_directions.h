// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/camera.h"

namespace lfm {

/// Unit directions in the camera frame through the pixel centres, rows from the top: made once a
/// camera, for undoing a lens takes longer than casting a ray. Zero where the lens model folds
/// back: such a pixel sees nothing. Parallel over rows; the result does not depend on the number of
/// threads.
std::vector<Eigen::Vector3d> PixelDirections(const Camera& camera);

}  // namespace lfm
