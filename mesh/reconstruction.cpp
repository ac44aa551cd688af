// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/reconstruction.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "core/ray_scene.h"
#include "mesh/alpha_wrap.h"
#include "mesh/base_closing.h"
#include "mesh/carving.h"
#include "mesh/consolidation.h"
#include "mesh/decimation.h"
#include "mesh/edge_quality.h"
#include "mesh/manifold_repair.h"
#include "mesh/nearest_points.h"
#include "mesh/plane_cut.h"
#include "mesh/point_fit.h"
#include "mesh/poisson.h"
#include "mesh/self_intersection.h"

namespace lfm {
namespace {

constexpr double kVoxelInCells = 0.5;
constexpr double kShortestEdgeInCells = 0.3;
constexpr double kSmallestCellInSpacings = 0.7;
constexpr int kShallowest = 5;
constexpr double kReachInCells = 2.5;
constexpr double kReachInSpacings = 3;
constexpr double kLikeNormalCosine = 0.2;
// What continues the object unseen counts less than what was measured.
constexpr double kContinuationWeight = 0.25;
// Nearer to measured points than this, what was seen through is noise of the points.
constexpr double kClearanceInCells = 1.5;
constexpr double kWrapOffsetInCells = 0.5;
constexpr double kFirstWrapInSteps = 4;
constexpr double kRoomyCube = 1.6;

double CellSize(const PointCloud& object, const PoissonSettings& settings) {
  Eigen::Vector3d low = object.points.front(), high = low;
  for (const Eigen::Vector3d& p : object.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  low.z() = std::min(low.z(), 0.0);
  return settings.cube_scale * (high - low).maxCoeff() / std::exp2(settings.depth);
}

// Poisson reads a point's weight from the length of its normal. Measured points, the mean of a cube
// each, have one weight: where only doubtful points lie nothing better competes with them, and
// weighed by their confidence they lose to the smoothness of what lies round them.
PointCloud WeighAndJoin(const PointCloud& measured, const PointCloud& continuation) {
  PointCloud joined = measured;
  for (size_t i = 0; i < continuation.points.size(); ++i) {
    joined.points.push_back(continuation.points[i]);
    joined.normals.push_back(kContinuationWeight * continuation.normals[i]);
  }
  joined.confidence.clear();
  return joined;
}

TriangleMesh Finish(const TriangleMesh& extracted, double cell_mm) {
  const TriangleMesh cut = CutAtPlatform(RepairToClosedManifold(extracted), cell_mm);
  return RemoveShortEdges(RepairToClosedManifold(cut), kShortestEdgeInCells * cell_mm);
}

struct Sources {
  const PointCloud& measured;      ///< consolidated
  const PointCloud& continuation;  ///< below the platform
  const FreeSpace& free;
  double cell_mm = 0;
};

// The border of what scans saw through in the solid that is closed without that knowledge, which
// half the resolution shows as well.
PointCloud FindBorder(const Sources& sources, PoissonSettings settings) {
  if (sources.free.Empty() || settings.depth <= kShallowest) return {};
  --settings.depth;
  const double cell_mm = 2 * sources.cell_mm;
  const TriangleMesh solid =
      CutAtPlatform(RepairToClosedManifold(ReconstructPoisson(
                        WeighAndJoin(sources.measured, sources.continuation), settings)),
                    cell_mm);
  return FindCarvedBorder(solid, sources.free, sources.measured, cell_mm,
                          kClearanceInCells * cell_mm);
}

TriangleMesh MakeByPoisson(const Sources& sources, const PoissonSettings& settings,
                           int64_t& carved_points) {
  PointCloud unseen = sources.continuation;
  const PointCloud border = FindBorder(sources, settings);
  carved_points = static_cast<int64_t>(border.points.size());
  unseen.points.insert(unseen.points.end(), border.points.begin(), border.points.end());
  unseen.normals.insert(unseen.normals.end(), border.normals.begin(), border.normals.end());
  return Finish(ReconstructPoisson(WeighAndJoin(sources.measured, unseen), settings),
                sources.cell_mm);
}

// A wrap knows inside from outside; the points that it was asked for may not.
void TakeNormalsFrom(const TriangleMesh& mesh, PointCloud& cloud) {
  const RayScene scene(mesh);
  ParallelFor(
      0, static_cast<int64_t>(cloud.points.size()),
      [&](int64_t i) {
        const auto closest = scene.Closest(cloud.points[i]);
        if (closest) cloud.normals[i] = TriangleNormal(mesh, closest->triangle);
      },
      256);
}

TriangleMesh MakeByWrap(const Sources& sources, double spacing_mm) {
  const double step = std::max(sources.cell_mm, spacing_mm);
  const double offset = kWrapOffsetInCells * sources.cell_mm;
  // What goes on below the platform follows from normals.
  PointCloud measured = sources.measured;
  TakeNormalsFrom(WrapPoints(measured, kFirstWrapInSteps * step, offset, sources.free).mesh,
                  measured);
  const PointCloud continuation = ContinueBelowPlatform(measured, sources.cell_mm);
  return Finish(WrapPoints(WeighAndJoin(measured, continuation), step, offset, sources.free).mesh,
                sources.cell_mm);
}

// Poisson, and once more in a roomier cube where the surface does not close in the first: what was
// not scanned bulges. The errors of both are reasons.
bool TryPoisson(const Sources& sources, PoissonSettings settings, Progress& progress,
                ReconstructedSurface& result) {
  const double usual_scale = settings.cube_scale;
  for (const double cube_scale : {usual_scale, kRoomyCube}) {
    settings.cube_scale = cube_scale;
    Sources scaled = sources;
    scaled.cell_mm *= cube_scale / usual_scale;
    try {
      result.mesh = MakeByPoisson(scaled, settings, result.carved_points);
      result.cell_mm = scaled.cell_mm;
      return true;
    } catch (const Error& error) {
      // Only what the points cannot give is worth another attempt; a failure of ours is not.
      if (error.kind() == ErrorKind::kSystem) throw;
      std::ostringstream reason;
      reason << "poisson left no closed surface in a cube " << cube_scale
             << " times as wide as the points (" << error.what() << ")";
      result.reasons.push_back(reason.str());
      progress.Note(result.reasons.back());
    }
  }
  return false;
}

// Fills in mesh, method and reasons.
void MakeSolid(const Sources& sources, double spacing_mm, const PoissonSettings& settings,
               SurfaceMethod asked, Progress& progress, ReconstructedSurface& result) {
  const MethodChoice choice = ChooseMethod(LookAtCloud(sources.measured), asked);
  result.method = choice.method;
  result.reasons.push_back(choice.reason);
  if (choice.method == SurfaceMethod::kPoisson) {
    if (TryPoisson(sources, settings, progress, result)) return;
    if (asked == SurfaceMethod::kPoisson) throw Error("reconstruction: " + result.reasons.back());
    result.reasons.emplace_back("wrap: poisson does not close what was scanned");
    result.method = SurfaceMethod::kWrap;
  }
  result.carved_points = 0;
  result.mesh = MakeByWrap(sources, spacing_mm);
}

std::vector<float> MeasureConfidence(const TriangleMesh& mesh, const PointCloud& measured,
                                     double reach_mm) {
  constexpr int kNeighbors = 6;
  const NearestPoints index(measured.points);
  std::vector<float> confidence(mesh.vertices.size(), 0);
  ParallelFor(
      0, static_cast<int64_t>(mesh.vertices.size()),
      [&](int64_t v) {
        if (mesh.vertices[v].z() <= 0) return;
        double sum = 0, nearest = reach_mm;
        int count = 0;
        for (const NearPoint& near : index.Find(mesh.vertices[v], kNeighbors)) {
          const bool alike = measured.normals[near.index].dot(mesh.normals[v]) > kLikeNormalCosine;
          if (near.distance >= reach_mm || !alike) continue;
          sum += measured.confidence[near.index];
          nearest = std::min(nearest, near.distance);
          ++count;
        }
        if (count == 0) return;
        const double share = nearest / reach_mm;
        confidence[v] = static_cast<float>(sum / count * (1 - 0.9 * share * share));
      },
      256);
  return confidence;
}

}  // namespace

ReconstructedSurface ReconstructSurface(const PointCloud& object, double spacing_mm,
                                        const ReconstructionSettings& settings,
                                        const FreeSpace& free, Progress& progress) {
  if (object.points.empty()) throw Error("reconstruction: there are no points");
  PoissonSettings poisson;
  poisson.depth = settings.depth;
  poisson.closed_below_mm = 0;
  // Cells much finer than the points' spacing hold nothing but noise, and tear the surface.
  while (poisson.depth > kShallowest &&
         CellSize(object, poisson) < kSmallestCellInSpacings * spacing_mm) {
    --poisson.depth;
  }
  progress.Start("reconstructing the surface", 4);
  ReconstructedSurface result;
  result.cell_mm = CellSize(object, poisson);
  PointCloud measured = ConsolidatePoints(object, kVoxelInCells * result.cell_mm);
  if (measured.points.empty()) throw Error("reconstruction: no point is left after cleaning");
  progress.Advance();
  const PointCloud continuation = ContinueBelowPlatform(measured, result.cell_mm);
  const Sources sources{measured, continuation, free, result.cell_mm};
  MakeSolid(sources, spacing_mm, poisson, settings.method, progress, result);
  progress.Advance();
  const TriangleMesh solid = FlipTowardsDelaunay(result.mesh);
  PointCloud of_wrap;
  if (result.method == SurfaceMethod::kWrap) {
    of_wrap = object;
    TakeNormalsFrom(solid, of_wrap);
    TakeNormalsFrom(solid, measured);
  }
  Untangled untangled = RemoveSelfIntersections(
      FitToPoints(solid, result.method == SurfaceMethod::kWrap ? of_wrap : object, result.cell_mm));
  result.mesh = std::move(untangled.mesh);
  result.self_intersections = untangled.left;
  progress.Advance();
  result.mesh.normals = ComputeVertexNormals(result.mesh);
  result.mesh.confidence =
      MeasureConfidence(result.mesh, measured,
                        std::max(kReachInCells * result.cell_mm, kReachInSpacings * spacing_mm));
  progress.Advance();
  return result;
}

}  // namespace lfm
