// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/decimation_target.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "core/ray_scene.h"
#include "mesh/count_search.h"
#include "mesh/decimation.h"
#include "mesh/edge_quality.h"
#include "mesh/error_bound.h"
#include "mesh/part_union.h"
#include "mesh/self_intersection.h"

namespace lfm {
namespace {

constexpr int64_t kDeviationSamples = 60000;

double Extent(const TriangleMesh& mesh) {
  Eigen::Vector3d low = mesh.vertices.front(), high = low;
  for (const Eigen::Vector3d& v : mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  return (high - low).maxCoeff();
}

// Where a surface crosses itself, as one that is put together from parts does at their joints.
class Crossings {
 public:
  explicit Crossings(const TriangleMesh& surface) {
    TriangleMesh crossing;
    crossing.vertices = surface.vertices;
    for (const auto& [a, b] : FindSelfIntersections(surface)) {
      ++pairs_;
      crossing.triangles.push_back(surface.triangles[a]);
      crossing.triangles.push_back(surface.triangles[b]);
    }
    if (pairs_ > 0) triangles_.emplace(crossing);
  }
  int pairs() const { return pairs_; }

  /// Whether a triangle of a mesh of that surface lies within its own size of a crossing.
  bool Reach(const TriangleMesh& mesh, int triangle) const {
    if (!triangles_) return false;
    const Eigen::Vector3i& t = mesh.triangles[triangle];
    const Eigen::Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]],
                          &c = mesh.vertices[t[2]];
    const auto closest = triangles_->Closest((a + b + c) / 3);
    return closest &&
           closest->distance <= std::max({(a - b).norm(), (b - c).norm(), (c - a).norm()});
  }

 private:
  int pairs_ = 0;
  std::optional<RayScene> triangles_;
};

// What the search needs again and again about the dense surface.
struct DenseSurface {
  explicit DenseSurface(const TriangleMesh& surface)
      : mesh(surface), scene(surface), samples(SampleSurface(surface, kDeviationSamples, 1)) {}
  /// Looked for when first asked.
  const Crossings& OwnCrossings() const {
    if (!crossings) crossings.emplace(mesh);
    return *crossings;
  }
  const TriangleMesh& mesh;
  RayScene scene;
  SurfaceSamples samples;
  mutable std::optional<Crossings> crossings;
};

SurfaceDeviation Deviation(const TriangleMesh& mesh, const DenseSurface& dense) {
  SurfaceDeviation deviation;
  std::vector<double> from_surface = DistancesToMesh(dense.samples.points, RayScene(mesh));
  std::vector<double> from_mesh =
      DistancesToMesh(SampleSurface(mesh, kDeviationSamples, 2).points, dense.scene);
  deviation.from_surface = SummarizeDistances(from_surface);
  deviation.from_mesh = SummarizeDistances(from_mesh);
  from_mesh.insert(from_mesh.end(), from_surface.begin(), from_surface.end());
  deviation.both = SummarizeDistances(std::move(from_mesh));
  return deviation;
}

DecimatedMesh Finish(const Decimation& decimation, const DenseSurface& dense) {
  DecimatedMesh result;
  // Some twenty samples a triangle bind all three corners well.
  const int64_t samples = std::max<int64_t>(20 * decimation.triangles(), 2000);
  result.mesh =
      ImproveTriangles(decimation.Mesh(), dense.scene, SampleSurface(dense.mesh, samples, 3));
  // What the surface does itself is not ours to part, nor are parts of it that lie close together:
  // they would shrink away from each other.
  const std::vector<int> parts = LabelParts(result.mesh);
  Untangled untangled = RemoveSelfIntersections(result.mesh, [&](int a, int b) {
    const Crossings& own = dense.OwnCrossings();
    return parts[a] != parts[b] || (own.Reach(result.mesh, a) && own.Reach(result.mesh, b));
  });
  result.mesh = std::move(untangled.mesh);
  result.self_intersections = untangled.left;
  result.deviation = Deviation(result.mesh, dense);
  return result;
}

// The surface as it is: what remains where nothing may be taken away.
DecimatedMesh Undecimated(const DenseSurface& dense) {
  DecimatedMesh result;
  result.mesh.vertices = dense.mesh.vertices;
  result.mesh.triangles = dense.mesh.triangles;
  result.self_intersections = dense.OwnCrossings().pairs();
  result.deviation = Deviation(result.mesh, dense);
  return result;
}

// The sagitta of a chord of length L on a circle of radius R is L^2 / (8 R); R is a sixth of the
// object's extent on many objects. Only where the search begins.
int64_t GuessCount(const TriangleMesh& surface, double tolerance_mm) {
  const double edge = std::sqrt(8 * Extent(surface) / 6 * tolerance_mm);
  const double count = TotalArea(surface) / (std::sqrt(3.0) / 4 * edge * edge);
  return static_cast<int64_t>(std::clamp(count, static_cast<double>(CountSearch::kFewest), 1e9));
}

// The coarsest mesh that is near enough; the search begins where `tolerance_mm` suggests.
DecimatedMesh FindCoarsest(const DenseSurface& dense, const Decimation& undone, double tolerance_mm,
                           const std::function<CountJudgement(const DecimatedMesh&)>& judge,
                           Progress& progress) {
  CountSearch search(GuessCount(dense.mesh, tolerance_mm),
                     static_cast<int64_t>(dense.mesh.triangles.size()));
  // From here most attempts start: what is far finer than needed is taken away once.
  Decimation finer = undone;
  finer.ReduceTo(16 * search.Next());
  std::optional<DecimatedMesh> best;
  for (int attempt = 1; !search.Done(); ++attempt) {
    Decimation decimation = search.Next() <= finer.triangles() ? finer : undone;
    decimation.ReduceTo(search.Next());
    DecimatedMesh tried = Finish(decimation, dense);
    if (attempt < kUsualAttempts) progress.Advance();
    CountJudgement judgement = judge(tried);
    if (judgement.near_enough && tried.self_intersections > 0) {
      judgement.near_enough = tried.self_intersections <= dense.OwnCrossings().pairs();
    }
    search.Learn(judgement);
    if (!judgement.near_enough) continue;
    best = std::move(tried);
    finer = decimation;
  }
  return best ? std::move(*best) : Undecimated(dense);
}

}  // namespace

SurfaceDeviation MeasureDeviation(const TriangleMesh& mesh, const TriangleMesh& surface) {
  return Deviation(mesh, DenseSurface(surface));
}

DecimatedMesh DecimateToCount(const DecimationSource& source, int64_t count) {
  const DenseSurface dense(source.surface);
  if (static_cast<int64_t>(source.surface.triangles.size()) <= count) return Undecimated(dense);
  Decimation decimation(source.surface, source.prices);
  decimation.ReduceTo(count);
  return Finish(decimation, dense);
}

DecimatedMesh DecimateToTolerance(const DecimationSource& source, double tolerance_mm,
                                  Progress& progress) {
  const DenseSurface dense(source.surface);
  return FindCoarsest(
      dense, Decimation(source.surface, source.prices), tolerance_mm,
      [&](const DecimatedMesh& tried) {
        const double error = tried.deviation.WorseP95() / tolerance_mm;
        return CountJudgement{error <= 1, error};
      },
      progress);
}

DecimatedMesh DecimateToMaxError(const DecimationSource& source, double max_mm,
                                 Progress& progress) {
  const DenseSurface dense(source.surface);
  DecimatedMesh result = FindCoarsest(
      dense, Decimation(source.surface, source.prices), 0.3 * max_mm,
      [&](const DecimatedMesh& tried) {
        // Samples refute sooner than a proof fails.
        const double error = tried.deviation.both.max / max_mm;
        return CountJudgement{error <= 1 && IsWithin(tried.mesh, dense.mesh, dense.scene, max_mm) &&
                                  IsWithin(dense.mesh, tried.mesh, RayScene(tried.mesh), max_mm),
                              error};
      },
      progress);
  const bool as_it_was = result.mesh.triangles.size() == source.surface.triangles.size();
  result.proven_error_mm = as_it_was ? 0 : max_mm;
  return result;
}

DecimatedMesh DecimateToMean(const DecimationSource& source, int64_t guess, double target,
                             const std::function<double(const TriangleMesh&)>& measure,
                             Progress& progress) {
  constexpr int kAttempts = 8;
  constexpr double kNearEnough_rel = 0.015;
  constexpr double kAreaKept = 0.9, kStepBack = 1.3, kLost = 1e3;
  const DenseSurface dense(source.surface);
  const double area = TotalArea(source.surface);
  const auto all = static_cast<int64_t>(source.surface.triangles.size());
  const Decimation undone(source.surface, source.prices);
  std::optional<DecimatedMesh> best;
  double best_error = 0;
  int64_t count = guess, fewest = std::min(CountSearch::kFewest, all);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    count = std::clamp(count, fewest, all);
    Decimation decimation = undone;
    decimation.ReduceTo(count);
    DecimatedMesh result = count < all ? Finish(decimation, dense) : Undecimated(dense);
    const double ratio = measure(result.mesh) / target;
    progress.Advance();
    // With so few triangles whole parts are gone, and what is measured is another object.
    const bool lost = TotalArea(result.mesh) < kAreaKept * area;
    if (lost) fewest = std::min<int64_t>(all, std::llround(kStepBack * static_cast<double>(count)));
    const double error = std::abs(std::log(std::max(ratio, 1e-9))) + (lost ? kLost : 0);
    if (!best || error < best_error) {
      best = std::move(result);
      best_error = error;
    }
    const int64_t next =
        lost ? fewest : std::llround(static_cast<double>(count) * std::clamp(ratio, 0.2, 5.0));
    if (error < kNearEnough_rel || next == count || (count == all && next > all) ||
        (next < fewest && count == fewest)) {
      break;
    }
    count = next;
  }
  return std::move(*best);
}

}  // namespace lfm
