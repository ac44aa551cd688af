// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/reconstruction.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "mesh/base_closing.h"
#include "mesh/consolidation.h"
#include "mesh/decimation.h"
#include "mesh/edge_quality.h"
#include "mesh/manifold_repair.h"
#include "mesh/nearest_points.h"
#include "mesh/plane_cut.h"
#include "mesh/point_fit.h"
#include "mesh/poisson.h"

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
constexpr double kLeastWeight = 0.1;

double CellSize(const PointCloud& object, const PoissonSettings& settings) {
  Eigen::Vector3d low = object.points.front(), high = low;
  for (const Eigen::Vector3d& p : object.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  low.z() = std::min(low.z(), 0.0);
  return settings.cube_scale * (high - low).maxCoeff() / std::exp2(settings.depth);
}

// Poisson reads a point's weight from the length of its normal.
PointCloud WeighAndJoin(const PointCloud& measured, const PointCloud& continuation) {
  PointCloud joined = measured;
  for (size_t i = 0; i < joined.points.size(); ++i) {
    joined.normals[i] *= std::max<double>(kLeastWeight, measured.confidence[i]);
  }
  for (size_t i = 0; i < continuation.points.size(); ++i) {
    joined.points.push_back(continuation.points[i]);
    joined.normals.push_back(kContinuationWeight * continuation.normals[i]);
  }
  joined.confidence.clear();
  return joined;
}

TriangleMesh ReconstructOnce(const PointCloud& measured, const PoissonSettings& settings,
                             double cell_mm) {
  const PointCloud continuation = ContinueBelowPlatform(measured, cell_mm);
  const TriangleMesh extracted = ReconstructPoisson(WeighAndJoin(measured, continuation), settings);
  const TriangleMesh cut = CutAtPlatform(RepairToClosedManifold(extracted), cell_mm);
  return RemoveShortEdges(RepairToClosedManifold(cut), kShortestEdgeInCells * cell_mm);
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

TriangleMesh ReconstructSurface(const PointCloud& object, double spacing_mm, int depth,
                                Progress& progress) {
  if (object.points.empty()) throw Error("reconstruction: there are no points");
  PoissonSettings settings;
  settings.depth = depth;
  // Cells much finer than the points' spacing hold nothing but noise, and tear the surface.
  while (settings.depth > kShallowest &&
         CellSize(object, settings) < kSmallestCellInSpacings * spacing_mm) {
    --settings.depth;
  }
  // PCL's extraction now and then loses edges where octree cells of different size meet, and the
  // holes it leaves cannot always be closed. Another cube puts the cells elsewhere; larger cells
  // bridge what was scanned thinly.
  constexpr int kAttempts = 6;
  constexpr double kScaleStep = 1.017;
  progress.Start("reconstructing the surface", kAttempts + 2);
  double cell_mm = 0;
  PointCloud measured;
  TriangleMesh surface;
  int attempt = 1;
  for (; surface.triangles.empty(); ++attempt) {
    cell_mm = CellSize(object, settings);
    measured = ConsolidatePoints(object, kVoxelInCells * cell_mm);
    if (measured.points.empty()) throw Error("reconstruction: no point is left after cleaning");
    try {
      surface = ReconstructOnce(measured, settings, cell_mm);
    } catch (const Error& error) {
      // Only what the points cannot give is worth another cube; a failure of ours is not.
      if (error.kind() == ErrorKind::kSystem || attempt == kAttempts) throw;
      settings.cube_scale *= kScaleStep;
      if (attempt > kAttempts / 2) settings.depth = std::max(kShallowest, settings.depth - 1);
      progress.Note("attempt " + std::to_string(attempt) + " of " + std::to_string(kAttempts) +
                    " left no closed surface (" + error.what() + "); trying again at depth " +
                    std::to_string(settings.depth));
    }
    progress.Advance();
  }
  progress.Advance(kAttempts + 1 - attempt);
  surface = FitToPoints(FlipTowardsDelaunay(surface), object, cell_mm);
  progress.Advance();
  surface.normals = ComputeVertexNormals(surface);
  surface.confidence = MeasureConfidence(
      surface, measured, std::max(kReachInCells * cell_mm, kReachInSpacings * spacing_mm));
  progress.Advance();
  return surface;
}

}  // namespace lfm
