// SPDX-License-Identifier: BSD-3-Clause
#include "resample/resample.h"

#include <algorithm>
#include <vector>

#include "core/parallel.h"
#include "core/process_memory.h"
#include "core/ray_scene.h"
#include "resample/photo_gains.h"
#include "resample/triangle_resampling.h"
#include "resample/triangle_shades.h"
#include "resample/used_photos.h"
#include "resample/view_weights.h"

namespace lfm {
namespace {

/// Sums over triangles, in whole numbers so that their order does not matter.
struct Totals {
  int64_t triangles = 0, unseen = 0;
  int64_t patch_samples = 0;           ///< of one view
  int64_t views = 0;                   ///< over triangles
  int64_t samples = 0, saturated = 0;  ///< over views
  int64_t missing = 0, hidden = 0;
  int64_t seen_entries = 0;

  void Add(const ResampledTriangle& triangle) {
    ++triangles;
    unseen += triangle.record.photos.empty() ? 1 : 0;
    patch_samples += PatchSampleCount(triangle.record.edge_samples);
    views += static_cast<int64_t>(triangle.record.photos.size());
    samples += triangle.samples;
    saturated += triangle.saturated;
    missing += triangle.missing;
    hidden += triangle.hidden;
    seen_entries += triangle.seen_entries;
  }
};

double Share(int64_t part, int64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

/// How many of the triangles from `first` on are resampled at a time.
size_t BatchSize(const ResampleScene& scene, const std::vector<TriangleViews>& block, size_t first,
                 const MemoryLimit& memory, int64_t bytes_left) {
  int64_t bytes = 0;
  for (size_t t = first; t < block.size(); ++t) {
    bytes += ResampleTriangleBytes(scene, block[t]);
    if (bytes <= bytes_left) continue;
    if (t > first) return t - first;
    memory.Require(bytes, "resampling the largest triangle",
                   "or take a smaller --max-edge-samples or --view-grid");
  }
  return block.size() - first;
}

Totals WriteTriangles(const ResampleScene& scene, const SeenPhotos& seen, LightFieldWriter& writer,
                      const MemoryLimit& memory, Progress& progress) {
  // Bounds memory, and lets the order in the file not depend on who finishes first.
  constexpr size_t kBlock = 256;
  const size_t count = scene.mesh.triangles.size();
  progress.Start("resampling triangles", static_cast<int64_t>(count));
  Totals totals;
  TriangleViewsReader reader(seen.lists);
  const int64_t bytes_left = memory.BytesLeft() - reader.BufferBytes();
  for (size_t begin = 0; begin < count; begin += kBlock) {
    const std::vector<TriangleViews> block =
        reader.Next(static_cast<int>(std::min(kBlock, count - begin)));
    for (size_t first = 0; first < block.size();) {
      std::vector<ResampledTriangle> batch(BatchSize(scene, block, first, memory, bytes_left));
      ParallelFor(0, static_cast<int64_t>(batch.size()), [&](int64_t i) {
        const size_t t = first + static_cast<size_t>(i);
        batch[static_cast<size_t>(i)] =
            ResampleTriangle(scene, static_cast<int>(begin + t), block[t]);
        progress.Advance();
      });
      for (const ResampledTriangle& triangle : batch) {
        writer.Write(triangle.record);
        totals.Add(triangle);
      }
      seen.file.Release();
      first += batch.size();
    }
  }
  return totals;
}

/// Finds gains, and when they are wanted sets the levels that photographs are read by.
void UsePhotoGains(const ResampleScene& scene, SeenPhotos& seen, ResampleResult& result) {
  const PhotoGainUse use = scene.options.photo_gains;
  if (use == PhotoGainUse::kOff) return;
  PhotoGains gains = EstimatePhotoGains(MeasureShades(scene, seen.lists), seen.photos.size());
  result.gain_error_without = gains.error_without;
  result.gain_error_with = gains.error_with;
  if (use == PhotoGainUse::kAuto && !gains.Needed()) return;
  for (size_t p = 0; p < seen.photos.size(); ++p) {
    seen.photos[p].levels = LevelsWithGain(gains.gains[p]);
  }
  result.photo_gains = std::move(gains.gains);
}

/// What the meshes' own forms take beside them: the surface's rays; the mesh's frames, normals and
/// deviations, its copy, its form in the file, and the file's index.
int64_t MeshBytes(const TriangleMesh& surface, const TriangleMesh& mesh) {
  constexpr int64_t kSurfaceTriangle = 250, kVertex = 250, kTriangle = 64;
  return kSurfaceTriangle * static_cast<int64_t>(surface.triangles.size()) +
         kVertex * static_cast<int64_t>(mesh.vertices.size()) +
         kTriangle * static_cast<int64_t>(mesh.triangles.size());
}

}  // namespace

ResampleResult Resample(const Capture& capture, const CalibResult& calib,
                        const TriangleMesh& surface, const TriangleMesh& mesh,
                        const ImageLoader& load_image, const ResampleOptions& options,
                        const std::filesystem::path& lfs_file, Progress& progress) {
  ResampleOptions checked = options;
  ValidateOptions(AnyOptions(checked));
  ValidateMesh(surface, "the dense surface");
  ValidateMesh(mesh, "the mesh");
  const std::vector<UsedPhoto> photos = FindUsedPhotos(capture, calib);
  const MemoryLimit memory(options.memory_mib);
  memory.Require(MeshBytes(surface, mesh), "preparing the meshes",
                 "or take fewer triangles (lfm-mesh --triangle-count)");

  LightFieldWriter::Header header;
  header.mesh = mesh;
  header.vertex_frames = ComputeVertexFrames(mesh);
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    header.mesh.normals.resize(mesh.vertices.size());
    header.mesh.normals[v] = header.vertex_frames[v].col(2);
  }
  for (const UsedPhoto& photo : photos) header.photo_ids.push_back(photo.id);
  header.direction_map = options.direction_map;
  header.grid = options.view_grid;

  const RayScene surface_scene(surface);
  const std::vector<double> deviations_mm = TriangleDeviations(mesh, surface_scene);
  SeenPhotos seen =
      LookAtPhotos(photos, {surface, surface_scene, mesh, deviations_mm, options, lfs_file},
                   load_image, memory, progress);
  const std::vector<Eigen::Vector2d> grid_in_plane =
      GridInPlane(options.direction_map, options.view_grid);
  const ResampleScene scene{header.mesh,
                            surface_scene,
                            header.vertex_frames,
                            photos,
                            seen.photos,
                            grid_in_plane,
                            options,
                            *std::max_element(deviations_mm.begin(), deviations_mm.end())};
  ResampleResult result;
  UsePhotoGains(scene, seen, result);
  LightFieldWriter writer(lfs_file, header);
  const Totals totals = WriteTriangles(scene, seen, writer, memory, progress);
  writer.Finish();

  const int64_t entries = int64_t{options.view_grid} * options.view_grid;
  result.photo_ids = header.photo_ids;
  result.mean_visible_views = Share(totals.views, totals.triangles);
  result.samples_per_triangle = Share(totals.patch_samples, totals.triangles);
  result.dense_bytes = 3 * totals.patch_samples * entries;
  result.unseen_triangles = static_cast<int>(totals.unseen);
  result.saturated_share = Share(totals.saturated, totals.samples);
  result.near_edge_share = Share(totals.missing - totals.hidden, totals.samples);
  result.hidden_share = Share(totals.hidden, totals.samples);
  result.seen_directions_share = Share(totals.seen_entries, 3 * totals.triangles * entries);
  return result;
}

}  // namespace lfm
