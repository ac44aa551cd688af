// SPDX-License-Identifier: BSD-3-Clause
#include "resample/triangle_resampling.h"

#include <algorithm>

#include "resample/saturation.h"
#include "resample/view_weights.h"

namespace lfm {
namespace {

constexpr float kCeiling = 65535.0F / LightField::kOne;

struct Views {
  std::vector<uint16_t> photos;
  std::vector<SampledView> sampled;
};

Views SampleViews(const ResampleScene& scene, const TriangleViews& candidates,
                  const std::vector<Eigen::Vector3d>& points) {
  Views views;
  for (const uint16_t p : candidates.photos) {
    const UsedPhoto& photo = scene.photos[p];
    auto sampled = SampleView(scene.seen[p].pixels, photo.camera, photo.camera_from_world, points);
    if (!sampled) continue;
    views.photos.push_back(p);
    views.sampled.push_back(std::move(*sampled));
  }
  return views;
}

/// Values as the file has them: views innermost.
std::vector<uint16_t> Interleave(const std::vector<SampledView>& views, size_t rows) {
  std::vector<uint16_t> values(rows * views.size());
  for (size_t v = 0; v < views.size(); ++v) {
    for (size_t row = 0; row < rows; ++row) values[row * views.size() + v] = views[v].values[row];
  }
  return values;
}

void ImputeSaturated(const std::vector<SampledView>& views, size_t rows,
                     std::vector<uint16_t>& values) {
  const auto count = static_cast<Eigen::Index>(views.size());
  CensoredMatrix matrix;
  matrix.values.resize(static_cast<Eigen::Index>(rows), count);
  matrix.is_censored.resize(matrix.values.rows(), count);
  for (Eigen::Index v = 0; v < count; ++v) {
    const SampledView& view = views[static_cast<size_t>(v)];
    for (Eigen::Index row = 0; row < matrix.values.rows(); ++row) {
      matrix.values(row, v) =
          static_cast<float>(view.values[static_cast<size_t>(row)]) / LightField::kOne;
      matrix.is_censored(row, v) = view.saturated[static_cast<size_t>(row)] != 0;
    }
  }
  const Eigen::MatrixXf imputed = ImputeCensored(matrix, kCeiling);
  for (Eigen::Index row = 0; row < imputed.rows(); ++row) {
    for (Eigen::Index v = 0; v < count; ++v) {
      if (!matrix.is_censored(row, v)) continue;
      values[static_cast<size_t>(row * count + v)] =
          static_cast<uint16_t>(std::min(imputed(row, v) * LightField::kOne + 0.5F, 65535.0F));
    }
  }
}

int64_t CountSaturated(const std::vector<SampledView>& views) {
  int64_t count = 0;
  for (const SampledView& view : views) {
    for (size_t s = 0; s < view.saturated.size(); s += 3) {
      count += (view.saturated[s] | view.saturated[s + 1] | view.saturated[s + 2]) != 0 ? 1 : 0;
    }
  }
  return count;
}

void WeighViews(const ResampleScene& scene, int triangle, ResampledTriangle& result) {
  const Eigen::Vector3i& corners = scene.mesh.triangles[static_cast<size_t>(triangle)];
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  for (int c = 0; c < 3; ++c) centroid += scene.mesh.vertices[static_cast<size_t>(corners[c])] / 3;
  std::vector<Eigen::Vector2d> in_plane(result.record.photos.size());
  for (int c = 0; c < 3; ++c) {
    const Eigen::Matrix3d& frame = scene.vertex_frames[static_cast<size_t>(corners[c])];
    for (size_t v = 0; v < in_plane.size(); ++v) {
      const Pose& pose = scene.photos[result.record.photos[v]].camera_from_world;
      const Eigen::Vector3d to_eye = (pose.Center() - centroid).normalized();
      in_plane[v] = PlaneFromDirection(scene.options.direction_map, frame.transpose() * to_eye);
    }
    auto& weights = result.record.weights[static_cast<size_t>(c)];
    weights = ComputeViewWeights(in_plane, scene.grid_in_plane);
    result.seen_entries += std::count(weights.seen.begin(), weights.seen.end(), 1);
  }
}

}  // namespace

std::vector<TriangleViews> GatherViews(const std::vector<SeenPhoto>& seen, size_t triangle_count) {
  std::vector<TriangleViews> views(triangle_count);
  for (size_t p = 0; p < seen.size(); ++p) {
    for (const VisibleTriangle& visible : seen[p].triangles) {
      TriangleViews& of_triangle = views[static_cast<size_t>(visible.triangle)];
      of_triangle.photos.push_back(static_cast<uint16_t>(p));
      of_triangle.largest_px = std::max(of_triangle.largest_px, visible.area_px);
    }
  }
  return views;
}

ResampledTriangle ResampleTriangle(const ResampleScene& scene, int triangle,
                                   const TriangleViews& candidates) {
  ResampledTriangle result;
  LightFieldWriter::Triangle& record = result.record;
  record.edge_samples = ChooseEdgeSamples(candidates.largest_px, scene.options.max_edge_samples);
  const std::vector<Eigen::Vector3d> points =
      PatchPoints(scene.mesh, triangle, record.edge_samples, scene.options.sample_on, scene.surface,
                  scene.max_shift_mm);
  const Views views = SampleViews(scene, candidates, points);
  if (views.photos.empty()) return result;
  record.photos = views.photos;
  record.values = Interleave(views.sampled, 3 * points.size());
  result.samples = static_cast<int64_t>(points.size() * views.photos.size());
  result.saturated = CountSaturated(views.sampled);
  if (result.saturated > 0) ImputeSaturated(views.sampled, 3 * points.size(), record.values);
  WeighViews(scene, triangle, result);
  return result;
}

}  // namespace lfm
