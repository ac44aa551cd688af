// SPDX-License-Identifier: BSD-3-Clause
#include "core/pixel_directions.h"

#include "core/parallel.h"

namespace lfm {

std::vector<Eigen::Vector3d> PixelDirections(const Camera& camera) {
  std::vector<Eigen::Vector3d> directions(static_cast<size_t>(camera.width) * camera.height);
  ParallelFor(0, camera.height, [&](int64_t y) {
    for (int x = 0; x < camera.width; ++x) {
      directions[static_cast<size_t>(y) * camera.width + x] =
          TryUnproject(camera, {x, static_cast<double>(y)})
              .value_or(Eigen::Vector3d(Eigen::Vector3d::Zero()));
    }
  });
  return directions;
}

}  // namespace lfm
