// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/surface_comparison.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "core/error.h"

namespace lfm {
namespace {

// Farther away, the single precision of searches is coarser than any surface.
constexpr double kFarthest_mm = 1e6;

double ShareWithin(const std::vector<double>& distances, double threshold_mm) {
  if (distances.empty()) return 0;
  const auto within =
      std::count_if(distances.begin(), distances.end(), [&](double d) { return d < threshold_mm; });
  return static_cast<double>(within) / static_cast<double>(distances.size());
}

}  // namespace

SurfaceComparison CompareDistances(std::vector<double> from_mesh,
                                   std::vector<double> from_reference, double threshold_mm) {
  if (!(threshold_mm > 0)) throw Error("surface comparison: the threshold must be positive");
  SurfaceComparison comparison;
  comparison.threshold_mm = threshold_mm;
  comparison.accuracy = ShareWithin(from_mesh, threshold_mm);
  comparison.completeness = ShareWithin(from_reference, threshold_mm);
  const double sum = comparison.accuracy + comparison.completeness;
  if (sum > 0) comparison.f_score = 2 * comparison.accuracy * comparison.completeness / sum;
  comparison.from_mesh = SummarizeDistances(from_mesh);
  comparison.from_reference = SummarizeDistances(from_reference);
  from_mesh.insert(from_mesh.end(), from_reference.begin(), from_reference.end());
  comparison.both = SummarizeDistances(std::move(from_mesh));
  return comparison;
}

SurfaceComparison CompareSurfaces(const TriangleMesh& mesh, const TriangleMesh& reference,
                                  double threshold_mm, int64_t samples) {
  return CompareDistances(DistancesToMesh(SampleSurface(mesh, samples, 11).points, reference),
                          DistancesToMesh(SampleSurface(reference, samples, 12).points, mesh),
                          threshold_mm);
}

void ValidateReference(const TriangleMesh& reference, const std::string& where) {
  ValidateMesh(reference, where.c_str());
  for (size_t v = 0; v < reference.vertices.size(); ++v) {
    const double farthest = reference.vertices[v].cwiseAbs().maxCoeff();
    if (farthest <= kFarthest_mm) continue;
    std::ostringstream message;
    message << where << ": vertex " << v << " has a coordinate of " << farthest
            << " mm, beyond a kilometre; check the mesh and its unit";
    throw Error(message.str());
  }
  if (!(TotalArea(reference) > 0)) {
    throw Error(where + ": its triangles have no area; export the mesh again");
  }
}

nlohmann::json ComparisonToJson(const SurfaceComparison& c) {
  const auto statistics = [](const DistanceStatistics& s) -> nlohmann::json {
    return {{"samples", s.samples},  {"mean_mm", s.mean}, {"rms_mm", s.rms},
            {"median_mm", s.median}, {"p95_mm", s.p95},   {"max_mm", s.max}};
  };
  return {{"version", 1},
          {"from_surface", statistics(c.from_mesh)},
          {"from_reference", statistics(c.from_reference)},
          {"both", statistics(c.both)},
          {"threshold_mm", c.threshold_mm},
          {"accuracy", c.accuracy},
          {"completeness", c.completeness},
          {"f_score", c.f_score}};
}

}  // namespace lfm
