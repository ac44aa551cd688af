// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "core/camera.h"

namespace lfm {

/// Rays of a camera, precomputed: per pixel the undistorted normalised coordinates (X/Z, Y/Z) of
/// its centre and their change a pixel step, so that rays through points of a pixel cost a few
/// multiplications. Within a pixel the second-order error is below 1e-4 px for |k1| <= 0.3.
class PixelRays {
 public:
  explicit PixelRays(const Camera& camera);

  const Camera& camera() const { return camera_; }
  /// The same rays with (shift_x, shift_y) added to every normalised coordinate: those of a point
  /// of the lens away from its middle (ExposureSamples). Cheap; the tables are shared.
  PixelRays Shifted(float shift_x, float shift_y) const;
  /// Direction in the camera frame, z = 1, through (x + dx, y + dy).
  Eigen::Vector3f Direction(int x, int y, float dx, float dy) const {
    const Entry& e = (*entries_)[static_cast<size_t>(y) * camera_.width + x];
    return {e.x + dx * e.x_by_column + dy * e.x_by_row + shift_x_,
            e.y + dx * e.y_by_column + dy * e.y_by_row + shift_y_, 1.0f};
  }

 private:
  struct Entry {
    float x, y, x_by_column, x_by_row, y_by_column, y_by_row;
  };
  Camera camera_;
  std::shared_ptr<const std::vector<Entry>> entries_;
  float shift_x_ = 0, shift_y_ = 0;
};

/// Points of a pixel that its value is averaged over, relative to its centre, in [-1/2, 1/2]: all
/// 4 (16) rows and columns of a 4 (16) grid are used once, and the points are symmetric.
inline constexpr int kCoarseSamples = 4, kFineSamples = 16;
extern const float kCoarsePattern[kCoarseSamples][2];
extern const float kFinePattern[kFineSamples][2];

}  // namespace lfm
