// SPDX-License-Identifier: BSD-3-Clause
#include "resample/triangle_shades.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>

#include "core/image.h"
#include "core/parallel.h"
#include "resample/patch_sampling.h"

namespace lfm {
namespace {

constexpr int kEdgeSamples = 4;
constexpr size_t kLeastViews = 6;
constexpr size_t kMostTriangles = 1000;  // 50 000 views: a hundred gains are known to 0.1 %

/// No answer when a sample is no data in any channel.
std::optional<Eigen::Vector3d> MeanRadiance(const SampledView& view) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < view.values.size(); ++i) {
    if (view.knowledge[i] != Knowledge::kData) return std::nullopt;
    const float coded = static_cast<float>(view.values[i]) / LightField::kOne;
    sum[static_cast<Eigen::Index>(i % 3)] += LinearFromSrgb(coded);
  }
  return sum / (static_cast<double>(view.values.size()) / 3);
}

TriangleShades ShadesOf(const ResampleScene& scene, int triangle, const TriangleViews& views) {
  const Eigen::Vector3i& corners = scene.mesh.triangles[static_cast<size_t>(triangle)];
  const auto vertex = [&](int c) { return scene.mesh.vertices[static_cast<size_t>(corners[c])]; };
  const Eigen::Vector3d centroid = (vertex(0) + vertex(1) + vertex(2)) / 3;
  const Eigen::Vector3d x = (vertex(1) - vertex(0)).normalized();
  const Eigen::Vector3d normal = x.cross(vertex(2) - vertex(0)).normalized();
  const Eigen::Vector3d y = normal.cross(x);
  const std::vector<Eigen::Vector3d> points =
      PatchPoints(scene.mesh, triangle, kEdgeSamples, scene.options.sample_on, scene.surface,
                  scene.max_shift_mm);
  TriangleShades shades;
  for (size_t i = 0; i < views.photos.size(); ++i) {
    if (views.hidden_beyond_mm[i] > 0) continue;  // parts of it show something else
    const uint16_t p = views.photos[i];
    const UsedPhoto& photo = scene.photos[p];
    const auto radiance = MeanRadiance(
        SampleView(scene.seen[p].pixels, photo.camera, photo.camera_from_world, points));
    if (!radiance) continue;
    const Eigen::Vector3d to_eye = (photo.camera_from_world.Center() - centroid).normalized();
    shades.photos.push_back(p);
    shades.radiance.push_back(*radiance);
    shades.directions.emplace_back(x.dot(to_eye), y.dot(to_eye));
  }
  return shades;
}

}  // namespace

std::vector<TriangleShades> MeasureShades(const ResampleScene& scene,
                                          const std::vector<TriangleViews>& views) {
  std::vector<int> seen;
  for (size_t t = 0; t < views.size(); ++t) {
    const auto& hidden = views[t].hidden_beyond_mm;
    const auto in_sight = static_cast<size_t>(std::count(hidden.begin(), hidden.end(), 0.0));
    if (in_sight >= kLeastViews) seen.push_back(static_cast<int>(t));
  }
  const size_t count = std::min(kMostTriangles, seen.size());
  std::vector<TriangleShades> shades(count);
  ParallelFor(
      0, static_cast<int64_t>(count),
      [&](int64_t i) {
        const int triangle = seen[static_cast<size_t>(i) * seen.size() / count];
        shades[static_cast<size_t>(i)] =
            ShadesOf(scene, triangle, views[static_cast<size_t>(triangle)]);
      },
      16);
  return shades;
}

}  // namespace lfm
