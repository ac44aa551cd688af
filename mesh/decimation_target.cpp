// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/decimation_target.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "core/ray_scene.h"
#include "mesh/decimation.h"
#include "mesh/edge_quality.h"
#include "mesh/error_bound.h"
#include "mesh/self_intersection.h"

namespace lfm {
namespace {

constexpr int64_t kDeviationSamples = 60000;
constexpr int64_t kFewestTriangles = 16;
constexpr double kCountPrecision = 1.03;
constexpr double kLongestStep = 8;

double Extent(const TriangleMesh& mesh) {
  Eigen::Vector3d low = mesh.vertices.front(), high = low;
  for (const Eigen::Vector3d& v : mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  return (high - low).maxCoeff();
}

// What the search needs again and again about the dense surface.
struct DenseSurface {
  explicit DenseSurface(const TriangleMesh& surface)
      : mesh(surface), scene(surface), samples(SampleSurface(surface, kDeviationSamples, 1)) {}
  const TriangleMesh& mesh;
  RayScene scene;
  SurfaceSamples samples;
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
  Untangled untangled = RemoveSelfIntersections(result.mesh);
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
  result.self_intersections = static_cast<int>(FindSelfIntersections(result.mesh).size());
  result.deviation = Deviation(result.mesh, dense);
  return result;
}

// The sagitta of a chord of length L on a circle of radius R is L^2 / (8 R); R is a sixth of the
// object's extent on many objects. Only where the search begins.
int64_t GuessCount(const TriangleMesh& surface, double tolerance_mm) {
  const double edge = std::sqrt(8 * Extent(surface) / 6 * tolerance_mm);
  const double count = TotalArea(surface) / (std::sqrt(3.0) / 4 * edge * edge);
  return static_cast<int64_t>(std::clamp(count, static_cast<double>(kFewestTriangles), 1e9));
}

// What a search thinks of a mesh.
struct Judgement {
  bool near_enough = false;
  double error = 0;  ///< in units of what is allowed; falls when triangles become more
};

// A number of triangles that was tried.
struct Tried {
  int64_t count = 0;
  double error = 0;
};

// Where the errors of a mesh that is near enough and of one that is not say that the limit lies,
// were their logarithms on a line; in the middle where they do not say so. Never so near to either
// that nothing would be learnt.
int64_t Between(const Tried& fine, const Tried& coarse, bool middle) {
  const double gap = std::log(static_cast<double>(fine.count) / static_cast<double>(coarse.count));
  const double least = 0.5 * std::log(kCountPrecision);
  double from_coarse = 0.5 * gap;
  if (!middle && coarse.error > 1 && fine.error > 0) {
    from_coarse = gap * std::log(coarse.error) / std::log(coarse.error / fine.error);
  }
  from_coarse = std::clamp(from_coarse, least, std::max(gap - least, least));
  return std::llround(static_cast<double>(coarse.count) * std::exp(from_coarse));
}

// Where only one side of the limit is known: errors fall about like 1 / count. Aimed a little
// beyond the limit, that the other side may be known next.
int64_t Beyond(const Tried& tried, bool near_enough) {
  const double aim = std::sqrt(kCountPrecision);
  const double factor = near_enough
                            ? std::clamp(tried.error / aim, 1 / kLongestStep, 1 / kCountPrecision)
                            : std::clamp(tried.error * aim, kCountPrecision, kLongestStep);
  return std::llround(static_cast<double>(tried.count) * factor);
}

// The coarsest mesh that is near enough, by false position over the number of triangles; the
// search begins where `tolerance_mm` suggests.
DecimatedMesh FindCoarsest(const DenseSurface& dense, const Decimation& undone, double tolerance_mm,
                           const std::function<Judgement(const DecimatedMesh&)>& judge,
                           Progress& progress) {
  const int64_t all = static_cast<int64_t>(dense.mesh.triangles.size());
  int64_t count = std::min(GuessCount(dense.mesh, tolerance_mm), all);
  // From here most attempts start: what is far finer than needed is taken away once.
  Decimation finer = undone;
  finer.ReduceTo(16 * count);
  std::optional<DecimatedMesh> best;
  Tried fine, coarse;  // near enough; not near enough
  int in_a_row = 0;    // attempts on the same side of the limit
  bool last_near = false;
  while (count < all) {
    Decimation decimation = count <= finer.triangles() ? finer : undone;
    decimation.ReduceTo(count);
    DecimatedMesh result = Finish(decimation, dense);
    progress.Advance();
    const Judgement judgement = judge(result);
    in_a_row = judgement.near_enough == last_near ? in_a_row + 1 : 1;
    last_near = judgement.near_enough;
    (judgement.near_enough ? fine : coarse) = {count, judgement.error};
    if (judgement.near_enough) {
      best = std::move(result);
      finer = decimation;
      if (count <= kFewestTriangles) break;
    }
    if (fine.count == 0 || coarse.count == 0) {
      count = std::max(Beyond(last_near ? fine : coarse, last_near), kFewestTriangles);
      continue;
    }
    const bool settled =
        static_cast<double>(fine.count) <= kCountPrecision * static_cast<double>(coarse.count);
    count = Between(fine, coarse, in_a_row > 1);
    if (settled || count <= coarse.count || count >= fine.count) break;
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
        return Judgement{error <= 1, error};
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
        return Judgement{error <= 1 && IsWithin(tried.mesh, dense.mesh, dense.scene, max_mm) &&
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
  const DenseSurface dense(source.surface);
  const auto all = static_cast<int64_t>(source.surface.triangles.size());
  const Decimation undone(source.surface, source.prices);
  std::optional<DecimatedMesh> best;
  double best_error = 0;
  int64_t count = guess;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    count = std::clamp(count, std::min(kFewestTriangles, all), all);
    Decimation decimation = undone;
    decimation.ReduceTo(count);
    DecimatedMesh result = count < all ? Finish(decimation, dense) : Undecimated(dense);
    const double ratio = measure(result.mesh) / target;
    progress.Advance();
    const double error = std::abs(std::log(std::max(ratio, 1e-9)));
    if (!best || error < best_error) {
      best = std::move(result);
      best_error = error;
    }
    const int64_t next = std::llround(static_cast<double>(count) * std::clamp(ratio, 0.2, 5.0));
    if (error < kNearEnough_rel || next == count || (count == all && next > all)) break;
    count = next;
  }
  return std::move(*best);
}

}  // namespace lfm
