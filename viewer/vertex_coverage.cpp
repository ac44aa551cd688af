// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/vertex_coverage.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "core/ray_scene.h"

namespace lfm {
namespace {

constexpr double kMaxGrazing_deg = 80;
// Rays are cast in float32: a vertex's own triangles are hit this near to it (of the extent).
constexpr double kOnSurface_rel = 1e-5;
constexpr int64_t kAtOnce = 1024;  // vertices or triangles a task

struct Surface {
  const TriangleMesh& mesh;
  RayScene rays;
  VertexRings rings;
  std::vector<Eigen::Vector3d> normals;  // of triangles
  double on_surface_mm;
};

Surface MakeSurface(const TriangleMesh& mesh) {
  Surface surface{mesh, RayScene(mesh), ComputeVertexRings(mesh), {}, 0};
  surface.normals.resize(mesh.triangles.size());
  ParallelFor(
      0, static_cast<int64_t>(mesh.triangles.size()),
      [&](int64_t t) {
        surface.normals[static_cast<size_t>(t)] = TriangleNormal(mesh, static_cast<int>(t));
      },
      kAtOnce);
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : mesh.vertices) box.extend(vertex);
  surface.on_surface_mm = kOnSurface_rel * box.diagonal().norm();
  return surface;
}

bool Faces(const Surface& surface, int64_t vertex, const Eigen::Vector3d& to_eye) {
  static const double kLeastCosine = std::cos(kMaxGrazing_deg * std::numbers::pi / 180);
  const std::span<const int> ring = surface.rings.Ring(vertex);
  return std::any_of(ring.begin(), ring.end(), [&](int triangle) {
    const Eigen::Vector3d& normal = surface.normals[static_cast<size_t>(triangle)];
    return normal.dot(to_eye) > kLeastCosine * to_eye.norm();
  });
}

/// The vertices from `begin` to `end` that a camera sees: one more each.
void CountSeen(const Surface& surface, const PosedCamera& camera, int64_t begin, int64_t end,
               std::vector<int>& counts) {
  const Eigen::Vector3d eye = camera.camera_from_world.Center();
  std::vector<int64_t> candidates;
  std::vector<Eigen::Vector3d> from_eye;
  for (int64_t v = begin; v < end; ++v) {
    const Eigen::Vector3d& vertex = surface.mesh.vertices[static_cast<size_t>(v)];
    if (!Faces(surface, v, eye - vertex)) continue;
    const auto pixel = Project(camera.camera, camera.camera_from_world * vertex);
    if (!pixel || !camera.camera.Contains(*pixel)) continue;
    candidates.push_back(v);
    from_eye.push_back(vertex - eye);
  }
  std::vector<double> hits(candidates.size());
  surface.rays.FirstDistances(eye, from_eye, hits);
  for (size_t i = 0; i < candidates.size(); ++i) {
    const double before_mm = (1 - hits[i]) * from_eye[i].norm();
    if (before_mm <= surface.on_surface_mm) ++counts[static_cast<size_t>(candidates[i])];
  }
}

}  // namespace

std::vector<int> CountPhotographs(const TriangleMesh& mesh, std::span<const PosedCamera> cameras,
                                  Progress& progress) {
  const Surface surface = MakeSurface(mesh);
  const auto vertices = static_cast<int64_t>(mesh.vertices.size());
  progress.Start("counting photographs", vertices);
  std::vector<int> counts(mesh.vertices.size());
  ParallelChunks(vertices, kAtOnce, [&](int64_t begin, int64_t end, int64_t) {
    for (const PosedCamera& camera : cameras) CountSeen(surface, camera, begin, end, counts);
    progress.Advance(end - begin);
  });
  return counts;
}

}  // namespace lfm
