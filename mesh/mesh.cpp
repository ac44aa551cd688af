// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "core/ray_scene.h"
#include "mesh/cleaning.h"
#include "mesh/decimation_target.h"
#include "mesh/pixel_footprint.h"
#include "mesh/reconstruction.h"

namespace lfm {
namespace {

constexpr double kGivenSamplesPerTriangle = 40;

// Nothing on the platform is as far from its centre as the cameras usually are. Test photographs
// are for scoring and have no say.
double CameraDistance(const CalibResult& calib) {
  std::vector<double> distances;
  for (const auto* images : {&calib.photos, &calib.scans}) {
    for (const PosedImage& image : *images) {
      if (image.split != PhotoSplit::kTrain) continue;
      distances.push_back(image.camera_from_world.Center().norm());
    }
  }
  if (distances.empty()) return std::numeric_limits<double>::infinity();
  std::nth_element(distances.begin(), distances.begin() + distances.size() / 2, distances.end());
  return distances[distances.size() / 2];
}

DecimatedMesh Decimate(const TriangleMesh& surface, double pixel_mm, const MeshOptions& options,
                       Progress& progress) {
  if (options.triangle_count > 0) {
    progress.Start("decimating", 1);
    return DecimateToCount(surface, options.triangle_count);
  }
  if (options.samples_per_triangle > 0) {
    progress.Start("decimating", 1);
    const double area_of_triangle = options.samples_per_triangle * pixel_mm * pixel_mm;
    return DecimateToCount(surface, std::llround(TotalArea(surface) / area_of_triangle));
  }
  progress.Start("finding the coarsest mesh", 9);
  return DecimateToTolerance(surface, options.tolerance_px * pixel_mm, progress);
}

// Confidence of the surface's closest points.
std::vector<float> TransferConfidence(const TriangleMesh& mesh, const TriangleMesh& surface,
                                      const RayScene& surface_scene) {
  std::vector<float> confidence(mesh.vertices.size());
  ParallelFor(
      0, static_cast<int64_t>(confidence.size()),
      [&](int64_t v) {
        const auto closest = surface_scene.Closest(mesh.vertices[v]);
        if (!closest) return;
        const Eigen::Vector3i& corners = surface.triangles[closest->triangle];
        int nearest = corners[0];
        for (const int corner : {corners[1], corners[2]}) {
          if ((surface.vertices[corner] - closest->point).squaredNorm() <
              (surface.vertices[nearest] - closest->point).squaredNorm()) {
            nearest = corner;
          }
        }
        confidence[v] = surface.confidence[nearest];
      },
      256);
  return confidence;
}

void AddDecimated(DecimatedMesh decimated, const RayScene& surface_scene, MeshResult& result) {
  result.mesh = std::move(decimated.mesh);
  result.mesh.normals = ComputeVertexNormals(result.mesh);
  result.mesh.confidence = TransferConfidence(result.mesh, result.surface, surface_scene);
  result.deviation_mean_mm = decimated.deviation.both.mean;
  result.deviation_p95_mm = decimated.deviation.both.p95;
}

void CheckGivenMesh(const TriangleMesh& given) {
  ValidateMesh(given, "the capture's mesh");
  if (given.triangles.size() > static_cast<size_t>(std::numeric_limits<int>::max() / 4)) {
    throw Error("the capture's mesh: too many triangles");
  }
  std::map<std::pair<int, int>, int> seen;
  for (size_t t = 0; t < given.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto edge = std::pair(given.triangles[t][k], given.triangles[t][(k + 1) % 3]);
      if (!seen.emplace(edge, static_cast<int>(t)).second) {
        throw Error("the capture's mesh: triangles " + std::to_string(seen[edge]) + " and " +
                    std::to_string(t) +
                    " share an edge but face opposite ways, or more than two meet in it; repair "
                    "the mesh");
      }
    }
  }
  if (!ExamineTopology(given).manifold) {
    throw Error("the capture's mesh: it is not a manifold surface; repair the mesh");
  }
  if (!(TotalArea(given) > 0)) throw Error("the capture's mesh: it has no area");
}

}  // namespace

MeshResult BuildMesh(const PointCloud& points, const CalibResult& calib, const MeshOptions& options,
                     Progress& progress) {
  MeshOptions checked = options;
  ValidateOptions(AnyOptions(checked));
  progress.Start("cleaning the points", 1);
  const CleanCloud clean = CleanPoints(points, {options.platform_margin_mm, CameraDistance(calib)});
  progress.Advance();

  MeshResult result;
  result.surface =
      ReconstructSurface(clean.cloud, clean.spacing_mm, options.poisson_depth, progress);
  const RayScene scene(result.surface);
  result.pixel_mm = MedianPixelFootprint(result.surface, scene, calib);
  AddDecimated(Decimate(result.surface, result.pixel_mm, options, progress), scene, result);
  const MeshTopology topology = ExamineTopology(result.mesh);
  if (!topology.closed || !topology.manifold) {
    throw Error("mesh: the decimated mesh is not a closed manifold", ErrorKind::kSystem);
  }
  return result;
}

MeshResult PrepareGivenMesh(const TriangleMesh& given, const CalibResult& calib,
                            const MeshOptions& options, Progress& progress) {
  MeshOptions checked = options;
  ValidateOptions(AnyOptions(checked));
  CheckGivenMesh(given);
  MeshResult result;
  result.surface = given;
  if (ExamineTopology(given).closed && SignedVolume(given) < 0) {
    for (Eigen::Vector3i& t : result.surface.triangles) std::swap(t[1], t[2]);
    result.surface.normals.clear();
  }
  if (result.surface.normals.empty()) {
    result.surface.normals = ComputeVertexNormals(result.surface);
  }
  if (result.surface.confidence.empty()) {
    result.surface.confidence.assign(given.vertices.size(), 1);
  }
  const RayScene scene(result.surface);
  result.pixel_mm = MedianPixelFootprint(result.surface, scene, calib);

  const double count = static_cast<double>(given.triangles.size());
  const double samples = TotalArea(given) / count / (result.pixel_mm * result.pixel_mm);
  const double needed =
      options.samples_per_triangle > 0 ? options.samples_per_triangle : kGivenSamplesPerTriangle;
  const bool coarse_enough =
      options.triangle_count > 0 ? count <= options.triangle_count : samples >= needed;
  if (coarse_enough) {
    result.mesh = result.surface;
    return result;
  }
  AddDecimated(Decimate(result.surface, result.pixel_mm, options, progress), scene, result);
  return result;
}

}  // namespace lfm
