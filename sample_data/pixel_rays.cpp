// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/pixel_rays.h"

#include <utility>

#include "core/parallel.h"

namespace lfm {

const float kCoarsePattern[kCoarseSamples][2] = {
    {-0.125f, -0.375f}, {0.375f, -0.125f}, {-0.375f, 0.125f}, {0.125f, 0.375f}};

// (4 i + j, 4 j + i) cells of a 16 grid; with the offsets every row and column holds one point.
const float kFinePattern[kFineSamples][2] = {
    {-15 / 32.f, -15 / 32.f}, {-13 / 32.f, -7 / 32.f}, {-11 / 32.f, 1 / 32.f},
    {-9 / 32.f, 9 / 32.f},    {-7 / 32.f, -13 / 32.f}, {-5 / 32.f, -5 / 32.f},
    {-3 / 32.f, 3 / 32.f},    {-1 / 32.f, 11 / 32.f},  {1 / 32.f, -11 / 32.f},
    {3 / 32.f, -3 / 32.f},    {5 / 32.f, 5 / 32.f},    {7 / 32.f, 13 / 32.f},
    {9 / 32.f, -9 / 32.f},    {11 / 32.f, -1 / 32.f},  {13 / 32.f, 7 / 32.f},
    {15 / 32.f, 15 / 32.f}};

PixelRays::PixelRays(const Camera& camera) : camera_(camera) {
  std::vector<Entry> entries(static_cast<size_t>(camera.width) * camera.height);
  ParallelFor(0, camera.height, [&](int64_t y) {
    const auto normalized = [&](double column, double row) {
      const Eigen::Vector3d d = Unproject(camera, {column, row});
      return Eigen::Vector2d(d.x() / d.z(), d.y() / d.z());
    };
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector2d center = normalized(x, static_cast<double>(y));
      const Eigen::Vector2d by_column =
          normalized(x + 0.5, static_cast<double>(y)) - normalized(x - 0.5, static_cast<double>(y));
      const Eigen::Vector2d by_row =
          normalized(x, static_cast<double>(y) + 0.5) - normalized(x, static_cast<double>(y) - 0.5);
      entries[static_cast<size_t>(y) * camera.width + x] = {
          static_cast<float>(center.x()),    static_cast<float>(center.y()),
          static_cast<float>(by_column.x()), static_cast<float>(by_row.x()),
          static_cast<float>(by_column.y()), static_cast<float>(by_row.y())};
    }
  });
  entries_ = std::make_shared<const std::vector<Entry>>(std::move(entries));
}

PixelRays PixelRays::Shifted(float shift_x, float shift_y) const {
  PixelRays shifted = *this;
  shifted.shift_x_ += shift_x;
  shifted.shift_y_ += shift_y;
  return shifted;
}

}  // namespace lfm
