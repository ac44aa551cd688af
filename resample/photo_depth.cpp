// SPDX-License-Identifier: BSD-3-Clause
#include "resample/photo_depth.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lfm {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();

struct PixelBox {
  int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
};

/// Pixels that may show the surface: around its projected vertices, with room for the bow that the
/// lens gives to long edges between them.
PixelBox BoxAround(const TriangleMesh& surface, const Camera& camera,
                   const Pose& camera_from_world) {
  constexpr double kRoom_rel = 0.05, kRoom_px = 4;
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector3d& vertex : surface.vertices) {
    const auto pixel = Project(camera, camera_from_world * vertex);
    if (!pixel) return {0, camera.width, 0, camera.height};
    box.extend(*pixel);
  }
  const Eigen::Vector2d room = kRoom_rel * box.sizes() + Eigen::Vector2d::Constant(kRoom_px);
  const auto clamp = [](double value, int size) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(size)));
  };
  return {clamp(box.min().x() - room.x(), camera.width),
          clamp(box.max().x() + room.x() + 1, camera.width),
          clamp(box.min().y() - room.y(), camera.height),
          clamp(box.max().y() + room.y() + 1, camera.height)};
}

/// Whether a depth edge lies between pixels i and i + 1 of a line of `count` pixels, `stride` apart
/// in memory.
bool IsEdge(const float* depth, int i, int count, ptrdiff_t stride, double pixel_mm_per_mm) {
  const auto at = [&](int k) { return depth[k * stride]; };
  const float a = at(i), b = at(i + 1);
  const bool shown_a = a < kNothing, shown_b = b < kNothing;
  if (!shown_a || !shown_b) return shown_a != shown_b;
  const auto step = [&](int k) {  // between pixels k and k + 1; NaN where one shows nothing
    if (k < 0 || k + 1 >= count) return std::numeric_limits<float>::quiet_NaN();
    const float d = std::abs(at(k + 1) - at(k));
    return std::isinf(d) ? std::numeric_limits<float>::quiet_NaN() : d;
  };
  const float beside = std::fmin(step(i - 1), step(i + 1));
  const double allowed =
      4 * pixel_mm_per_mm * std::min(a, b) + 2 * (std::isnan(beside) ? 0.0F : beside);
  return std::abs(a - b) > allowed;
}

/// The pixels on both sides of depth edges.
std::vector<uint8_t> MarkEdges(const DepthMap& map, const Camera& camera) {
  std::vector<uint8_t> marked(map.depth.size(), 0);
  for (int y = 0; y < map.height; ++y) {
    const size_t row = static_cast<size_t>(y) * map.width;
    for (int x = 0; x < map.width; ++x) {
      const size_t at = row + x;
      if (x + 1 < map.width && IsEdge(&map.depth[row], x, map.width, 1, 1 / camera.fx)) {
        marked[at] = marked[at + 1] = 1;
      }
      if (y + 1 < map.height && IsEdge(&map.depth[x], y, map.height, map.width, 1 / camera.fy)) {
        marked[at] = marked[at + map.width] = 1;
      }
    }
  }
  return marked;
}

}  // namespace

DepthMap RenderDepth(const TriangleMesh& surface, const RayScene& scene, const Camera& camera,
                     const std::vector<Eigen::Vector3d>& directions,
                     const Pose& camera_from_world) {
  DepthMap map{camera.width, camera.height, {}};
  map.depth.assign(directions.size(), kNothing);
  const PixelBox box = BoxAround(surface, camera, camera_from_world);
  const Pose world_from_camera = camera_from_world.Inverse();
  const auto width = static_cast<size_t>(std::max(0, box.x_end - box.x_begin));
  std::vector<Eigen::Vector3d> rays(width);
  std::vector<double> distances(width);
  for (int y = box.y_begin; y < box.y_end; ++y) {
    const size_t first = static_cast<size_t>(y) * map.width + box.x_begin;
    for (size_t x = 0; x < width; ++x) {
      const Eigen::Vector3d& ray = directions[first + x];
      rays[x] = ray.z() > 0 ? Eigen::Vector3d(world_from_camera.rotation * ray)
                            : Eigen::Vector3d::Zero();  // which meets nothing
    }
    scene.FirstDistances(world_from_camera.translation, rays, distances);
    for (size_t x = 0; x < width; ++x) {
      if (std::isinf(distances[x])) continue;
      map.depth[first + x] = static_cast<float>(distances[x] * directions[first + x].z());
    }
  }
  return map;
}

std::vector<PixelUse> FindUsablePixels(const DepthMap& map, const Camera& camera,
                                       double margin_px) {
  const std::vector<uint8_t> marked = MarkEdges(map, camera);
  std::vector<PixelUse> usable(map.depth.size(), PixelUse::kNearEdge);
  for (size_t i = 0; i < usable.size(); ++i) {
    if (map.depth[i] < kNothing) usable[i] = PixelUse::kData;
  }
  const double radius = margin_px - 0.5;
  const int reach = std::max(0, static_cast<int>(std::ceil(radius)));
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      if (marked[static_cast<size_t>(y) * map.width + x] == 0) continue;
      for (int dy = std::max(-reach, -y); dy <= std::min(reach, map.height - 1 - y); ++dy) {
        for (int dx = std::max(-reach, -x); dx <= std::min(reach, map.width - 1 - x); ++dx) {
          if (std::hypot(dx, dy) >= radius) continue;
          usable[static_cast<size_t>(y + dy) * map.width + (x + dx)] = PixelUse::kNearEdge;
        }
      }
    }
  }
  return usable;
}

}  // namespace lfm
