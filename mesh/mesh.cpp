// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/mesh.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
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
#include "mesh/normal_estimation.h"
#include "mesh/part_union.h"
#include "mesh/patch_samples.h"
#include "mesh/photo_detail.h"
#include "mesh/pixel_footprint.h"
#include "mesh/reconstruction.h"
#include "mesh/self_intersection.h"
#include "mesh/thinning.h"

namespace lfm {
namespace {

constexpr double kGivenSamplesPerTriangle = 40;

constexpr int64_t kMostPoints = 4000000;
constexpr double kFreeMarginInSpacings = 4;

std::vector<const PosedImage*> TrainImages(const CalibResult& calib) {
  std::vector<const PosedImage*> train;
  for (const auto* images : {&calib.photos, &calib.scans}) {
    for (const PosedImage& image : *images) {
      if (image.split == PhotoSplit::kTrain) train.push_back(&image);
    }
  }
  return train;
}

double MedianDistance(const std::vector<const PosedImage*>& images, const Eigen::Vector3d& from) {
  std::vector<double> distances;
  for (const PosedImage* image : images) {
    distances.push_back((image->camera_from_world.Center() - from).norm());
  }
  std::nth_element(distances.begin(), distances.begin() + distances.size() / 2, distances.end());
  return distances[distances.size() / 2];
}

// The point nearest to all lines of sight; the origin where they are as good as parallel.
Eigen::Vector3d LookedAt(const std::vector<const PosedImage*>& images) {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (const PosedImage* image : images) {
    const Eigen::Vector3d axis = image->camera_from_world.rotation.row(2).transpose();
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - axis * axis.transpose();
    a += across;
    b += across * image->camera_from_world.Center();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(a);
  if (!(solver.eigenvalues()[0] > 1e-2 * solver.eigenvalues()[2])) return Eigen::Vector3d::Zero();
  return a.ldlt().solve(b);
}

// Nothing on the platform is as far from its centre as the cameras usually are. Test photographs
// are for scoring and have no say. A capture whose world lies elsewhere is measured from where its
// cameras look.
CleaningLimits LimitsOf(const CalibResult& calib, const MeshOptions& options) {
  CleaningLimits limits;
  limits.platform_margin_mm = options.platform_margin_mm;
  const std::vector<const PosedImage*> train = TrainImages(calib);
  if (train.empty()) return limits;
  const Eigen::Vector3d looked_at = LookedAt(train);
  limits.max_distance_mm = MedianDistance(train, Eigen::Vector3d::Zero());
  const double from_there = MedianDistance(train, looked_at);
  if (looked_at.norm() > 0.5 * limits.max_distance_mm && from_there < limits.max_distance_mm) {
    limits.center = looked_at;
    limits.max_distance_mm = from_there;
  }
  return limits;
}

// Estimates normals where there are none, and thins what is more than the rest can hold.
PointCloud PreparePoints(const PointCloud& points, const std::string& where, Progress& progress) {
  PointCloud prepared = ThinPoints(points, kMostPoints, where);
  if (prepared.points.size() < points.points.size()) {
    progress.Note("points: " + std::to_string(points.points.size()) + " thinned to " +
                  std::to_string(prepared.points.size()));
  }
  if (prepared.normals.empty() && !prepared.points.empty()) {
    progress.Note("points: they have no normals; estimated from their neighbours");
    prepared = EstimateNormals(prepared);
  }
  return prepared;
}

// The surface, and what its parts are worth when texture counts.
DecimationSource PriceSurface(const TriangleMesh& surface, const RayScene& scene,
                              const CalibResult& calib, const MeshOptions& options,
                              const ImageLoader& load_image, Progress& progress) {
  if (options.texture_weight <= 0) return surface;
  if (!load_image) {
    throw Error("mesh: there are no photographs to weigh texture by; leave out --texture-weight");
  }
  std::vector<double> prices = MeasurePhotoDetail(surface, scene, calib, load_image, progress);
  for (double& price : prices) price = 1 + options.texture_weight * price;
  return {surface, std::move(prices)};
}

DecimatedMesh Decimate(const DecimationSource& source, const RayScene& scene, double pixel_mm,
                       const CalibResult& calib, const MeshOptions& options, Progress& progress) {
  if (options.triangle_count > 0) {
    progress.Start("decimating", 1);
    return DecimateToCount(source, options.triangle_count);
  }
  if (options.samples_per_triangle > 0) {
    progress.Start("decimating to the samples asked for", 8);
    const double area_of_triangle = options.samples_per_triangle * pixel_mm * pixel_mm;
    return DecimateToMean(
        source, std::llround(TotalArea(source.surface) / area_of_triangle),
        options.samples_per_triangle,
        [&](const TriangleMesh& mesh) { return PredictSamplesPerTriangle(mesh, scene, calib); },
        progress);
  }
  if (options.max_error_mm > 0) {
    progress.Start("finding the coarsest mesh within the error", kUsualAttempts);
    return DecimateToMaxError(source, options.max_error_mm, progress);
  }
  progress.Start("finding the coarsest mesh", kUsualAttempts);
  return DecimateToTolerance(source, options.tolerance_px * pixel_mm, progress);
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

void AddDecimated(DecimatedMesh decimated, const RayScene& surface_scene, const CalibResult& calib,
                  MeshResult& result) {
  result.mesh = std::move(decimated.mesh);
  result.mesh_self_intersections = decimated.self_intersections;
  result.mesh.normals = ComputeVertexNormals(result.mesh);
  result.mesh.confidence = TransferConfidence(result.mesh, result.surface, surface_scene);
  result.deviation_mean_mm = decimated.deviation.both.mean;
  result.deviation_p95_mm = decimated.deviation.both.p95;
  result.deviation_max_mm = std::max(decimated.deviation.both.max, decimated.proven_error_mm);
  result.samples_per_triangle = PredictSamplesPerTriangle(result.mesh, surface_scene, calib);
}

void CheckGivenMesh(const TriangleMesh& given, const std::string& where) {
  constexpr double kFarthest_mm = 1e7;
  ValidateMesh(given, where.c_str());
  for (const Eigen::Vector3d& v : given.vertices) {
    if (v.cwiseAbs().maxCoeff() > kFarthest_mm) {
      throw Error(where +
                  ": a vertex lies more than 10 km from the origin; coordinates are in "
                  "millimetres, in the frame of the poses");
    }
  }
  if (given.triangles.size() > static_cast<size_t>(std::numeric_limits<int>::max() / 4)) {
    throw Error(where + ": too many triangles");
  }
  std::map<std::pair<int, int>, int> seen;
  for (size_t t = 0; t < given.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto edge = std::pair(given.triangles[t][k], given.triangles[t][(k + 1) % 3]);
      if (!seen.emplace(edge, static_cast<int>(t)).second) {
        throw Error(where + ": triangles " + std::to_string(seen[edge]) + " and " +
                    std::to_string(t) +
                    " share an edge but face opposite ways, or more than two meet in it; repair "
                    "the mesh");
      }
    }
  }
  if (!ExamineTopology(given).manifold) {
    throw Error(where + ": it is not a manifold surface; repair the mesh");
  }
  if (!(TotalArea(given) > 0)) throw Error(where + ": it has no area");
}

}  // namespace

void MeshOptions::CheckTargets() const {
  std::vector<std::string> set;
  if (samples_per_triangle > 0) set.emplace_back("--samples-per-triangle");
  if (triangle_count > 0) set.emplace_back("--triangle-count");
  if (max_error_mm > 0) set.emplace_back("--max-error-mm");
  if (set.size() < 2) return;
  std::string names = set.front();
  for (size_t i = 1; i < set.size(); ++i) names += (i + 1 < set.size() ? ", " : " and ") + set[i];
  throw Error(names + " are targets of which a mesh can have one; leave out the others");
}

MeshResult BuildMesh(const PointCloud& points, const std::vector<ScanSight>& sights,
                     const CalibResult& calib, const MeshOptions& options, Progress& progress,
                     const ImageLoader& load_image, const std::string& where) {
  MeshOptions checked = options;
  ValidateOptions(AnyOptions(checked));
  progress.Start("cleaning the points", 1);
  CleanCloud clean =
      CleanPoints(PreparePoints(points, where, progress), LimitsOf(calib, options), where);
  // Strays and the platform mislead estimated normals: once more without them.
  if (points.normals.empty()) clean.cloud = EstimateNormals(clean.cloud);
  progress.Advance();

  const FreeSpace free(points, sights, kFreeMarginInSpacings * clean.spacing_mm);
  ReconstructedSurface reconstructed = ReconstructSurface(
      clean.cloud, clean.spacing_mm, {options.method, options.poisson_depth}, free, progress);
  MeshResult result;
  result.surface = std::move(reconstructed.mesh);
  result.method = NameOf(reconstructed.method);
  result.reasons = std::move(reconstructed.reasons);
  result.carved_points = reconstructed.carved_points;
  result.surface_self_intersections = reconstructed.self_intersections;
  const RayScene scene(result.surface);
  result.pixel_mm = MedianPixelFootprint(result.surface, scene, calib);
  const DecimationSource source =
      PriceSurface(result.surface, scene, calib, options, load_image, progress);
  AddDecimated(Decimate(source, scene, result.pixel_mm, calib, options, progress), scene, calib,
               result);
  const MeshTopology topology = ExamineTopology(result.mesh);
  if (!topology.closed || !topology.manifold) {
    throw Error("mesh: the decimated mesh is not a closed manifold", ErrorKind::kSystem);
  }
  return result;
}

MeshResult PrepareGivenMesh(const TriangleMesh& given, const CalibResult& calib,
                            const MeshOptions& options, Progress& progress,
                            const ImageLoader& load_image, const std::string& where) {
  MeshOptions checked = options;
  ValidateOptions(AnyOptions(checked));
  CheckGivenMesh(given, where);
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
  result.surface_self_intersections =
      static_cast<int>(FindSelfIntersections(result.surface).size());
  RayScene scene(result.surface);
  try {
    result.pixel_mm = MedianPixelFootprint(result.surface, scene, calib);
  } catch (const Error& e) {
    throw Error(where + ": " + e.what() + " (is the mesh in the frame of the poses?)", e.kind());
  }

  const double count = static_cast<double>(given.triangles.size());
  const double samples = TotalArea(given) / count / (result.pixel_mm * result.pixel_mm);
  const double needed =
      options.samples_per_triangle > 0 ? options.samples_per_triangle : kGivenSamplesPerTriangle;
  const bool coarse_enough =
      options.triangle_count > 0 ? count <= options.triangle_count : samples >= needed;
  if (coarse_enough) {
    result.mesh = result.surface;
    result.mesh_self_intersections = result.surface_self_intersections;
    result.samples_per_triangle = PredictSamplesPerTriangle(result.mesh, scene, calib);
    return result;
  }
  if (result.surface_self_intersections > 0) {
    // No triangle of what is decimated is to be spent on what lies inside.
    if (auto united = UniteParts(result.surface, progress)) {
      progress.Note("given mesh: " + std::to_string(united->united) +
                    " parts that cross others have their outer surface alone now");
      united->mesh.confidence = TransferConfidence(united->mesh, result.surface, scene);
      united->mesh.normals = ComputeVertexNormals(united->mesh);
      result.surface = std::move(united->mesh);
      result.surface_self_intersections =
          static_cast<int>(FindSelfIntersections(result.surface).size());
      scene = RayScene(result.surface);
    }
  }
  const DecimationSource source =
      PriceSurface(result.surface, scene, calib, options, load_image, progress);
  AddDecimated(Decimate(source, scene, result.pixel_mm, calib, options, progress), scene, calib,
               result);
  return result;
}

}  // namespace lfm
