// SPDX-License-Identifier: BSD-3-Clause
#include "encode/model_error.h"

#include <algorithm>
#include <vector>

#include "core/error.h"
#include "core/image_metrics.h"
#include "core/parallel.h"
#include "encode/decoded_term.h"
#include "encode/patch_resolution.h"

namespace lfm {
namespace {

// With the first 0, 1, ... terms of the vertex.
std::vector<ModelError> VertexErrors(const LightFieldSource& source, const LightFieldModel& model,
                                     std::span<const int> ring, int vertex) {
  const bool holds_mean = model.mean_in_terms && model.vertex_terms[vertex] > 0;
  const VertexOperator f = BuildVertexOperator(source, vertex, ring, [&](int triangle) {
    PatchMean mean = MeanAtResolution(model, triangle, source.patch(triangle).edge_samples);
    if (holds_mean) mean.assign(mean.size(), 0.f);
    return mean;
  });
  ModelError error;
  for (const RingBlock& block : f.blocks) {
    if (block.views > 0) error.entries += int64_t{block.samples} * f.cols();
  }
  error.squared_error = ComputeEnergies(f, std::vector<float>(f.directions, 1.f)).plain;
  std::vector<ModelError> errors = {error};
  std::vector<DecodedTerm> terms;
  for (int k = 0; k < model.vertex_terms[vertex]; ++k) {
    const TermMaps maps = TermAtResolution(model, f, ring, vertex, k);
    DecodedTerm& term = terms.emplace_back();
    DecodeSurface(f, maps, term);
    DecodeView(f, maps, term);
    error.squared_error += ErrorChange(terms);
    errors.push_back({std::max(error.squared_error, 0.0), error.entries});
  }
  return errors;
}

void CheckSameObject(const LightFieldSource& source, const LightFieldModel& model) {
  bool same = source.grid == model.grid && source.direction_map == model.direction_map &&
              source.mesh.triangles == model.mesh.triangles &&
              source.mesh.vertices.size() == model.mesh.vertices.size();
  for (size_t t = 0; same && t < model.placements.size(); ++t) {
    // Patches of codebooks may have fewer samples than the light field's.
    const int n = source.patch(static_cast<int>(t)).edge_samples;
    const int own = model.placements[t].edge_samples;
    const bool coarser = !model.surface_placements.empty() || model.terms == 0;
    same = n == own || (coarser && n >= 2 && (n - 1) % (own - 1) == 0);
  }
  if (!same) throw Error("the model and the light field are not of one mesh and one view grid");
}

}  // namespace

double ModelError::psnr_db() const {
  return entries == 0 ? 99
                      : PsnrFromMse(255.0 * 255.0 * squared_error / static_cast<double>(entries));
}

ModelError CompareWithLightField(const LightFieldSource& source, const LightFieldModel& model) {
  return CompareByTerms(source, model).back();
}

std::vector<ModelError> CompareByTerms(const LightFieldSource& source,
                                       const LightFieldModel& model) {
  ValidateModel(model, "the model");
  CheckSameObject(source, model);
  const VertexRings rings = ComputeVertexRings(source.mesh);
  std::vector<std::vector<ModelError>> errors(source.mesh.vertices.size());
  ParallelFor(0, static_cast<int64_t>(errors.size()), [&](int64_t v) {
    const auto ring = rings.Ring(v);
    errors[v] = VertexErrors(source, model, ring, static_cast<int>(v));
  });
  std::vector<ModelError> totals(model.terms + 1);
  for (const std::vector<ModelError>& own : errors) {
    for (size_t k = 0; k < totals.size(); ++k) {
      const ModelError& error = own[std::min(k, own.size() - 1)];
      totals[k].squared_error += error.squared_error;
      totals[k].entries += error.entries;
    }
  }
  return totals;
}

}  // namespace lfm
