// SPDX-License-Identifier: BSD-3-Clause
#include "resample/triangle_resampling.h"

#include <algorithm>
#include <cmath>

#include "resample/area_sampling.h"
#include "resample/imputation.h"
#include "resample/view_weights.h"

namespace lfm {
namespace {

constexpr float kCeiling = 65535.0F / LightField::kOne;

int EdgeSamples(const ResampleScene& scene, const TriangleViews& views) {
  return ChooseEdgeSamples(scene.options.sample_density * views.largest_px,
                           scene.options.max_edge_samples);
}

/// Of a photograph that lies in a file: what becomes resident when a triangle is sampled. The
/// system maps 64 KiB at a time.
int64_t BytesRead(const PhotoPixels& pixels, double area_px) {
  if (pixels.in_file == nullptr) return 0;
  constexpr int64_t kWindow = 1 << 16;
  const int64_t row = 4 * int64_t{pixels.width};
  const auto rows = static_cast<int64_t>(2 * std::sqrt(area_px)) + 2;
  return std::min(rows * std::min(row, kWindow) + kWindow, row * pixels.height + kWindow);
}

struct Views {
  std::vector<uint16_t> photos;
  std::vector<SampledView> sampled;
};

/// Hides the samples from which the surface stands away that the photograph shows in their place:
/// before them, or behind them where the mesh juts out over it.
void HideOccluded(const RayScene& surface, const Pose& camera_from_world, double hidden_beyond_mm,
                  const std::vector<Eigen::Vector3d>& points, SampledView& view) {
  const Eigen::Vector3d eye = camera_from_world.Center();
  for (size_t s = 0; s < points.size(); ++s) {
    if (view.knowledge[3 * s] == Knowledge::kMissing) continue;
    const double z = (camera_from_world * points[s]).z();
    const auto hit = surface.Intersect(eye, points[s] - eye);  // the sample lies at distance 1
    if (!hit || std::abs(hit->distance - 1) * z > hidden_beyond_mm) HideSample(view, s);
  }
}

Views SampleViews(const ResampleScene& scene, const TriangleViews& candidates,
                  const std::vector<Eigen::Vector3d>& points, int edge_samples) {
  const auto count = static_cast<double>(points.size());
  const double needed = scene.options.min_data_share * count - 1e-9;
  const double spare = scene.options.max_hidden_share * count + 1e-9;
  Views views;
  for (size_t i = 0; i < candidates.photos.size(); ++i) {
    const uint16_t p = candidates.photos[i];
    const UsedPhoto& photo = scene.photos[p];
    const PhotoPixels& pixels = scene.seen[p];
    SampledView sampled =
        scene.options.sampling == Sampling::kEwa
            ? SampleViewByArea(pixels, photo.camera, photo.camera_from_world, points, edge_samples)
            : SampleView(pixels, photo.camera, photo.camera_from_world, points);
    if (candidates.hidden_beyond_mm[i] > 0) {
      HideOccluded(scene.surface, photo.camera_from_world, candidates.hidden_beyond_mm[i], points,
                   sampled);
    }
    if (sampled.data_samples < needed || sampled.hidden_samples > spare) continue;
    views.photos.push_back(p);
    views.sampled.push_back(std::move(sampled));
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

/// For each sample of a patch the nearest one about which some view knows something; itself where
/// that is so, and where nothing is known at all.
std::vector<int> NearestKnown(const std::vector<SampledView>& views, int n) {
  std::vector<Eigen::Vector2i> places;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i + j < n; ++i) places.emplace_back(i, j);
  }
  const auto is_known = [&](size_t sample) {
    return std::any_of(views.begin(), views.end(), [&](const SampledView& view) {
      return view.knowledge[3 * sample] != Knowledge::kMissing;
    });
  };
  std::vector<int> known, nearest(places.size());
  for (size_t s = 0; s < places.size(); ++s) {
    nearest[s] = static_cast<int>(s);
    if (is_known(s)) known.push_back(nearest[s]);
  }
  if (known.empty() || known.size() == places.size()) return nearest;
  for (size_t s = 0; s < places.size(); ++s) {
    const auto distance = [&](int other) {
      const Eigen::Vector2i d = places[s] - places[static_cast<size_t>(other)];
      return d.squaredNorm() + d.x() * d.y();  // of an equilateral lattice
    };
    nearest[s] = *std::min_element(known.begin(), known.end(),
                                   [&](int a, int b) { return distance(a) < distance(b); });
  }
  return nearest;
}

/// What is not data, estimated from what is: from other views of the same sample, and where no view
/// has it, from the nearest sample.
void ImputeRest(const std::vector<SampledView>& views, int edge_samples, int max_terms,
                std::vector<uint16_t>& values) {
  const size_t rows = 3 * static_cast<size_t>(PatchSampleCount(edge_samples));
  const auto count = static_cast<Eigen::Index>(views.size());
  PartialMatrix matrix;
  matrix.values.resize(static_cast<Eigen::Index>(rows), count);
  matrix.knowledge.resize(matrix.values.rows(), count);
  for (Eigen::Index v = 0; v < count; ++v) {
    const SampledView& view = views[static_cast<size_t>(v)];
    for (Eigen::Index row = 0; row < matrix.values.rows(); ++row) {
      matrix.values(row, v) =
          static_cast<float>(view.values[static_cast<size_t>(row)]) / LightField::kOne;
      matrix.knowledge(row, v) = view.knowledge[static_cast<size_t>(row)];
    }
  }
  const Eigen::MatrixXf imputed = Impute(matrix, kCeiling, max_terms);
  const std::vector<int> nearest = NearestKnown(views, edge_samples);
  for (Eigen::Index row = 0; row < imputed.rows(); ++row) {
    const Eigen::Index from = 3 * nearest[static_cast<size_t>(row / 3)] + row % 3;
    for (Eigen::Index v = 0; v < count; ++v) {
      if (matrix.knowledge(row, v) == Knowledge::kData) continue;
      values[static_cast<size_t>(row * count + v)] =
          static_cast<uint16_t>(std::min(imputed(from, v) * LightField::kOne + 0.5F, 65535.0F));
    }
  }
}

/// Samples that are not data: `kind` in any channel.
int64_t CountSamples(const std::vector<SampledView>& views, Knowledge kind) {
  int64_t count = 0;
  for (const SampledView& view : views) {
    for (auto at = view.knowledge.begin(); at != view.knowledge.end(); at += 3) {
      count += std::find(at, at + 3, kind) != at + 3 ? 1 : 0;
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
    weights = ComputeViewWeights(in_plane, scene.grid_in_plane, scene.options.hull_margin);
    result.seen_entries += std::count(weights.seen.begin(), weights.seen.end(), 1);
  }
}

}  // namespace

int64_t ResampleTriangleBytes(const ResampleScene& scene, const TriangleViews& views) {
  // Sampled, interleaved, and while gaps are filled as float and double.
  constexpr int64_t kBytesAValue = 40, kBytesAnEntry = 3 * 3 * 8, kRest = 4096;
  const int64_t samples = PatchSampleCount(EdgeSamples(scene, views));
  const auto entries = static_cast<int64_t>(scene.grid_in_plane.size());
  int64_t bytes = kRest + kBytesAnEntry * entries;
  for (const uint16_t p : views.photos) {
    bytes += kBytesAValue * 3 * samples + BytesRead(scene.seen[p], views.largest_px);
  }
  return bytes;
}

ResampledTriangle ResampleTriangle(const ResampleScene& scene, int triangle,
                                   const TriangleViews& candidates) {
  ResampledTriangle result;
  LightFieldWriter::Triangle& record = result.record;
  record.edge_samples = EdgeSamples(scene, candidates);
  const std::vector<Eigen::Vector3d> points =
      PatchPoints(scene.mesh, triangle, record.edge_samples, scene.options.sample_on, scene.surface,
                  scene.max_shift_mm);
  const Views views = SampleViews(scene, candidates, points, record.edge_samples);
  if (views.photos.empty()) return result;
  record.photos = views.photos;
  record.values = Interleave(views.sampled, 3 * points.size());
  result.samples = static_cast<int64_t>(points.size() * views.photos.size());
  result.saturated = CountSamples(views.sampled, Knowledge::kLowerBound);
  result.missing = CountSamples(views.sampled, Knowledge::kMissing);
  for (const SampledView& view : views.sampled) result.hidden += view.hidden_samples;
  if (result.saturated + result.missing > 0) {
    ImputeRest(views.sampled, record.edge_samples, scene.options.impute_terms, record.values);
  }
  WeighViews(scene, triangle, result);
  return result;
}

}  // namespace lfm
