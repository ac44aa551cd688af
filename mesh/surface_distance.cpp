// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "core/ray_scene.h"

namespace lfm {
namespace {

// SplitMix64 (Steele, Lea, Flood 2014): a hash of the counter, so that a sample does not depend on
// the ones before it and the loop can be split anywhere.
uint64_t SplitMix(uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

double UniformNumber(uint64_t seed, int64_t sample, uint64_t dimension) {
  const uint64_t bits = SplitMix(SplitMix(seed) ^ (static_cast<uint64_t>(sample) * 4 + dimension));
  return static_cast<double>(bits >> 11) * 0x1.0p-53;
}

double Quantile(const std::vector<double>& sorted, double share) {
  const double place = share * static_cast<double>(sorted.size() - 1);
  const size_t below = static_cast<size_t>(place);
  const size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

}  // namespace

DistanceStatistics SummarizeDistances(std::vector<double> distances_mm) {
  DistanceStatistics statistics;
  if (distances_mm.empty()) return statistics;
  double sum = 0, sum_of_squares = 0;
  for (const double d : distances_mm) {
    if (!std::isfinite(d) || d < 0) {
      throw Error("surface distances: a distance is negative or not finite");
    }
    sum += d;
    sum_of_squares += d * d;
  }
  std::sort(distances_mm.begin(), distances_mm.end());
  const double n = static_cast<double>(distances_mm.size());
  statistics.samples = static_cast<int64_t>(distances_mm.size());
  statistics.mean = sum / n;
  statistics.rms = std::sqrt(sum_of_squares / n);
  statistics.median = Quantile(distances_mm, 0.5);
  statistics.p95 = Quantile(distances_mm, 0.95);
  statistics.max = distances_mm.back();
  return statistics;
}

SurfaceSamples SampleSurface(const TriangleMesh& mesh, int64_t count, uint64_t seed) {
  ValidateMesh(mesh, "surface sampling");
  SurfaceSamples samples;
  if (count <= 0) return samples;
  std::vector<double> area_up_to(mesh.triangles.size());
  double total = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    total += TriangleArea(mesh, static_cast<int>(t));
    area_up_to[t] = total;
  }
  if (!(total > 0) || !std::isfinite(total)) {
    throw Error("surface sampling: the mesh has no area");
  }
  samples.points.resize(count);
  samples.normals.resize(count);
  samples.triangles.resize(count);
  ParallelFor(
      0, count,
      [&](int64_t i) {
        const double place =
            (static_cast<double>(i) + UniformNumber(seed, i, 0)) / static_cast<double>(count);
        const auto found = std::upper_bound(area_up_to.begin(), area_up_to.end(), place * total);
        size_t t = std::min<size_t>(found - area_up_to.begin(), mesh.triangles.size() - 1);
        while (t > 0 && area_up_to[t] == area_up_to[t - 1]) --t;
        // Square-root map of the unit square to the triangle (Osada et al. 2002, section 3.3).
        const double r = std::sqrt(UniformNumber(seed, i, 1)), s = UniformNumber(seed, i, 2);
        const Eigen::Vector3i& corners = mesh.triangles[t];
        samples.points[i] = (1 - r) * mesh.vertices[corners[0]] +
                            r * (1 - s) * mesh.vertices[corners[1]] +
                            r * s * mesh.vertices[corners[2]];
        samples.normals[i] = TriangleNormal(mesh, static_cast<int>(t));
        samples.triangles[i] = static_cast<int>(t);
      },
      1024);
  return samples;
}

std::vector<double> DistancesToMesh(const std::vector<Eigen::Vector3d>& points,
                                    const TriangleMesh& mesh) {
  ValidateMesh(mesh, "distances to a mesh");
  return DistancesToMesh(points, RayScene(mesh));
}

std::vector<double> DistancesToMesh(const std::vector<Eigen::Vector3d>& points,
                                    const RayScene& scene) {
  for (size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) {
      throw Error("distances to a mesh: point " + std::to_string(i) + " is not finite");
    }
  }
  std::vector<double> distances(points.size());
  ParallelFor(
      0, static_cast<int64_t>(points.size()),
      [&](int64_t i) {
        const auto closest = scene.Closest(points[i]);
        if (!closest) {
          throw Error("distances to a mesh: no closest point was found", ErrorKind::kSystem);
        }
        distances[i] = closest->distance;
      },
      256);
  return distances;
}

}  // namespace lfm
